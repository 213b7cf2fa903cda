//! The controller in the physics: the recorded Walk policy, closed loop, against its recording.

use std::sync::Arc;

use glam::Vec2;
use integration_tests::golden::{golden_walk, largest_difference};
use integration_tests::{DT_SECS, HUMANOID_MJCF, reference_pack};
use physics_bridge::{Character, Model, StateHash, Terrain};
use policy_core::{Command, Controller, ControllerConfig, Goal, GraphPosition, NodeId, PathId};

const TOLERANCE: f32 = 1e-5;

fn walking() -> (Character, Controller) {
    let pack = reference_pack();
    let start = pack.graph().node_named("walk").unwrap();
    // The recording was made without steering.
    let config = ControllerConfig { start, steering: None, ..ControllerConfig::default() };
    let controller = Controller::with_config(pack, config);
    let mut character = Character::new(&Model::from_mjcf(HUMANOID_MJCF).unwrap());
    let first = &golden_walk().ticks[0];
    character.set_pose(&first.qpos, &first.qvel).unwrap();
    (character, controller)
}

#[test]
fn every_recorded_state_gives_the_recorded_input_action_and_targets() {
    let golden = golden_walk();
    let (mut character, mut controller) = walking();
    let command = Command { target: Some(Vec2::from_array(golden.target_world)), ..Command::default() };
    let mut state = character.sensed().clone();
    for (index, tick) in golden.ticks.iter().enumerate() {
        character.set_pose(&tick.qpos, &tick.qvel).unwrap();
        character.sense_into(&mut state);
        let targets = controller.tick(&state, &command, DT_SECS).to_vec();
        let ctrl: Vec<f32> = tick.ctrl.iter().map(|&c| c as f32).collect();
        let scaling = controller.pack().action();
        let scaled = targets.iter().zip(scaling.centre()).zip(scaling.gain());
        let action: Vec<f32> = scaled.map(|((target, centre), gain)| (target - centre) / gain).collect();
        let compared = [
            ("policy input", controller.policy_input(), tick.policy_input.as_slice()),
            ("action", &action, &tick.action),
            ("ctrl", &targets, &ctrl),
        ];
        for (what, found, expected) in compared {
            let (at, difference) = largest_difference(found, expected);
            assert!(difference <= TOLERANCE, "tick {index}: {what}[{at}] differs by {difference}");
        }
    }
}

#[test]
fn walk_stays_up_for_ten_seconds_and_ends_where_the_recording_ends() {
    let golden = golden_walk();
    let (mut character, mut controller) = walking();
    let command = Command { target: Some(Vec2::from_array(golden.target_world)), ..Command::default() };
    for tick in 0..300 {
        character.control_tick(&mut controller, &command, DT_SECS).unwrap();
        let height = character.sensed().root().position.z;
        assert!(height > 0.7 && !controller.report().fallen, "pelvis at {height} m in tick {tick}");
    }
    let end = character.pose().qpos;
    let expected = &golden.final_qpos_after_300_ticks;
    let apart = (end[0] - expected[0]).hypot(end[1] - expected[1]);
    assert!(
        apart < 0.5,
        "ends {apart} m from the recording, which walked {} m",
        expected[0].hypot(expected[1])
    );
}

/// A trigger that moves, a target that turns, uneven ground: the same bits in every run.
fn hash_of_a_run(terrain: Terrain) -> u64 {
    let pack = reference_pack();
    let model = Model::from_mjcf(HUMANOID_MJCF).unwrap().with_terrain(terrain).unwrap();
    let mut character = Character::new(&model);
    let mut controller = Controller::new(Arc::clone(&pack));
    assert!(controller.place_at(GraphPosition::node(NodeId::new(1))));
    let mut hash = StateHash::default();
    for tick in 0..150u16 {
        let seconds = f32::from(tick) * DT_SECS;
        let command = Command {
            target: Some(Vec2::new(4.0 - seconds, seconds)),
            goal: Goal::Path { path: PathId::new(0), coordinate: 1.0 - 0.1 * seconds },
            ..Command::default()
        };
        character.control_tick(&mut controller, &command, DT_SECS).unwrap();
        hash.absorb(&character.pose());
    }
    hash.value()
}

#[test]
fn two_runs_give_the_same_bits_and_other_ground_others() {
    let wavy = Terrain::Wavy { height_m: 0.04, wavelength_m: 3.0, seed: 3 };
    assert_eq!(hash_of_a_run(wavy), hash_of_a_run(wavy));
    assert_ne!(hash_of_a_run(wavy), hash_of_a_run(Terrain::Flat));
}
