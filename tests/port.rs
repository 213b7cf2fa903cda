//! The golden values for ports are those that this implementation gives, and they cover what a port can get wrong.

use integration_tests::golden::largest_difference;
use integration_tests::golden::port::{PortTick, made_anew, port_golden};

/// An implementation in single precision agrees with another within this.
const TOLERANCE: f32 = 1e-5;

#[test]
fn the_golden_values_are_those_of_policy_core() {
    let golden = port_golden();
    let mut found = port_golden();
    found.ticks.iter_mut().for_each(|tick| tick.joint_targets.clear());
    found.evaluate();
    for (index, (tick, found)) in golden.ticks.iter().zip(&found.ticks).enumerate() {
        let names = |blend: &[(String, Vec<f32>)]| blend.iter().map(|b| b.0.clone()).collect::<Vec<_>>();
        assert_eq!(names(&found.blend), names(&tick.blend), "tick {index}");
        let flat = |blend: &[(String, Vec<f32>)]| blend.iter().flat_map(|b| b.1.clone()).collect::<Vec<_>>();
        for (what, found, expected) in [
            ("observation", &found.observation, &tick.observation),
            ("blend", &flat(&found.blend), &flat(&tick.blend)),
            ("policy_input", &found.policy_input, &tick.policy_input),
            ("action", &found.action, &tick.action),
            ("joint_targets", &found.joint_targets, &tick.joint_targets),
        ] {
            let (at, difference) = largest_difference(found, expected);
            assert!(difference <= TOLERANCE, "tick {index}: {what}[{at}] differs by {difference}");
        }
    }
}

#[test]
fn they_cover_blends_turns_and_standing() {
    let ticks = port_golden().ticks;
    assert!(ticks.len() >= 20);
    assert!(ticks.iter().any(|tick| tick.blend.len() == 2), "a blend");
    assert!(ticks.iter().any(|tick| tick.blend.len() == 1), "a policy alone");
    assert!(ticks.iter().any(|tick| tick.command.target.is_none()), "no target");
    let turned = ticks.iter().any(|tick| tick.state.rotations[0].z.abs() > 0.2);
    assert!(turned, "a heading off the world's axes, which conventions of quaternions show in");
    let moved = ticks.iter().any(|tick| tick.state.linear_velocities[0].length() > 0.3);
    assert!(moved, "velocities that matter");
    let rises = |tick: &PortTick| tick.state.ground_rises.iter().any(|rise| rise.abs() > 0.01);
    assert!(ticks.iter().any(rises), "uneven ground");
    assert!(ticks.iter().any(|tick| tick.state.ground_rises.is_empty()), "level ground");
}

/// Writes the file anew: `cargo test -p integration-tests --test port -- --ignored`.
#[test]
#[ignore = "writes a golden file; run it after a deliberate change of the observation or the controller"]
fn write_the_golden_values() {
    let json = serde_json::to_string(&made_anew()).unwrap();
    // A line for each tick keeps changes readable.
    let json = json.replace("{\"state\"", "\n{\"state\"") + "\n";
    std::fs::write(concat!(env!("CARGO_MANIFEST_DIR"), "/golden/port.json"), json).unwrap();
}
