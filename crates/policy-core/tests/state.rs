//! State as data: saved, sent, restored, kept over another pack.

mod common;

use std::sync::Arc;

use common::{n, standing};
use policy_core::format::Manifest;
use policy_core::glam::Vec2;
use policy_core::{
    BlendMode, CharacterPack, CharacterState, Command, Controller, ControllerConfig, ControllerState, Goal,
    PathId, StateError, StateFault, TurnAssist,
};
use proptest::prelude::*;

const DT: f32 = 1.0 / 30.0;

fn config() -> ControllerConfig {
    let turn_assist = Some(TurnAssist::default());
    ControllerConfig { handover_secs: 0.15, turn_assist, ..ControllerConfig::default() }
}

/// A made-up body that moves, falls and lies, and a player who does this and that.
fn tick_of(tick: usize) -> (CharacterState, Command) {
    let mut state = standing();
    let phase = tick as f32 * 0.37;
    for (i, body) in state.bodies.iter_mut().enumerate() {
        body.linear_velocity.x = (phase + i as f32).sin();
        body.position.y += 0.1 * (phase * 0.3 + i as f32).cos();
    }
    if (300..380).contains(&(tick % 500)) {
        state.bodies[0].position.z = 0.2;
    }
    let skill = (tick % 170 == 90).then(|| policy_core::SkillId::new(0));
    let coordinate = if tick % 100 < 50 { 1.3 } else { (tick % 31) as f32 * 0.1 };
    let goal = Goal::Path { path: PathId::new(tick / 250 % 2), coordinate };
    (
        state,
        Command {
            target: Some(Vec2::new(phase.sin(), phase.cos()) * 5.0),
            goal,
            skill,
            ..Command::default()
        },
    )
}

fn bits(controller: &Controller) -> Vec<u32> {
    controller.joint_targets().iter().map(|t| t.to_bits()).collect()
}

#[test]
fn a_controller_restored_at_any_tick_goes_on_with_the_same_bits() {
    let pack = Arc::new(common::pack(0.3));
    let mut run = Controller::with_config(pack.clone(), config());
    let mut saved = Vec::new();
    let mut expected = Vec::new();
    for tick in 0..700 {
        let mut state = ControllerState::new(&pack);
        run.save_into(&mut state);
        saved.push(state);
        let (body, command) = tick_of(tick);
        run.tick(&body, &command, DT);
        expected.push((bits(&run), *run.report()));
    }
    let kinds = expected.iter().filter(|(_, r)| r.skill.is_some()).count();
    let recovered = expected.iter().any(|(_, r)| r.skill_started == pack.recovery());
    assert!(kinds > 50 && recovered, "the run has skills and falls");
    let mut other = Controller::with_config(pack.clone(), config());
    let mut read = ControllerState::new(&pack);
    let mut bytes = vec![0; read.byte_len()];
    for start in (0..680).step_by(7) {
        saved[start].write_bytes(&mut bytes);
        read.read_bytes(&pack, &bytes).unwrap();
        assert_eq!(read, saved[start]);
        other.restore(&read).unwrap();
        for (tick, expected) in expected.iter().enumerate().skip(start).take(20) {
            let (body, command) = tick_of(tick);
            other.tick(&body, &command, DT);
            assert_eq!(&(bits(&other), *other.report()), expected, "tick {tick} from {start}");
        }
    }
}

#[test]
fn bad_bytes_are_refused_and_leave_a_new_state() {
    let pack = common::pack(0.0);
    let mut state = ControllerState::new(&pack);
    let mut good = vec![0; state.byte_len()];
    state.write_bytes(&mut good);
    let mut refused = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut bytes = good.clone();
        change(&mut bytes);
        let error = state.read_bytes(&pack, &bytes).expect_err("the bytes are bad");
        assert_eq!(state, ControllerState::new(&pack));
        error
    };
    assert!(matches!(refused(&|b| b.truncate(9)), StateError::Length { .. }));
    assert!(matches!(refused(&|b| b[3] ^= 0x80), StateError::Version { .. }));
    assert!(matches!(refused(&|b| b[4] = 200), StateError::Field { field: "position", .. }));
    let numbers = |b: &mut Vec<u8>| {
        let at = b.len() - RISE_LEN - 4;
        b[at..at + 4].copy_from_slice(&f32::NAN.to_le_bytes());
    };
    assert!(matches!(refused(&numbers), StateError::Field { field: "times", .. }));
    // Behind the flag of a turn lie the eight numbers of a capture step and of a catch.
    let flag = |b: &mut Vec<u8>| {
        let at = b.len() - RISE_LEN - 8 * 4 - 1;
        b[at] = 2;
    };
    assert!(matches!(refused(&flag), StateError::Field { field: "a flag", .. }));
}

/// Bytes of a rise, which come last: its variant and its share.
const RISE_LEN: usize = 2 + 4;

/// Bytes of a state with one number replaced: of the settling time, a share, a direction, a joint target and so on.
#[test]
fn numbers_out_of_their_ranges_are_refused() {
    let pack = Arc::new(common::pack(-4.0));
    let config = ControllerConfig { start: n(1), ..config() };
    let mut controller = Controller::with_config(pack.clone(), config);
    let roll = Command { skill: pack.skill_named("roll"), ..Command::default() };
    controller.tick(&standing(), &roll, DT);
    let mut state = ControllerState::new(&pack);
    controller.save_into(&mut state);
    let mut good = vec![0; state.byte_len()];
    state.write_bytes(&mut good);
    let len = good.len() - RISE_LEN;
    let steering = len - (13 + 12 + 57 + 24 + 8);
    let urgency = steering + 13 + 12;
    let mut field_of = |at: usize, number: f32| {
        let mut bytes = good.clone();
        bytes[at..at + 4].copy_from_slice(&number.to_le_bytes());
        match state.read_bytes(&pack, &bytes) {
            Ok(()) => "none",
            Err(StateError::Field { field, .. }) => field,
            Err(other) => panic!("{other}"),
        }
    };
    let [handover, settle, pending] = [steering - 12, steering - 8, steering - 4];
    for at in [handover, settle, urgency - 4, len - 4] {
        assert_eq!([1e30, -1.0, 3600.0].map(|n| field_of(at, n)), ["times", "times", "none"], "{at}");
    }
    assert_eq!([-1e30, 1e30, 5.0].map(|n| field_of(pending, n)), ["counted times", "counted times", "none"]);
    // Of the start, of the stop, of a capture step.
    for at in [urgency + 8 * 4, urgency + 10 * 4, len - 7 * 4] {
        assert_eq!(
            [11.0, -1.0, 0.3].map(|n| field_of(at, n)),
            ["times of moments", "times of moments", "none"]
        );
    }
    let shares = (0..8).chain([9, 11]).map(|i| urgency + 4 * i).chain([len - 32, len - 8, len + 2]);
    for at in shares {
        assert_eq!([1.5, -0.1, 1.0].map(|n| field_of(at, n)), ["shares", "shares", "none"], "{at}");
    }
    // Of a turn, of steps, of where they face.
    for at in [urgency + 12 * 4, len - 24, len - 16] {
        assert_eq!([3.0, 1e-3, 1.0].map(|n| field_of(at, n)), ["directions", "directions", "none"], "{at}");
    }
    for at in [handover - 4, handover - 4 - 4 * 28] {
        assert_eq!([1e38, -1e38, 99.0].map(|n| field_of(at, n)), ["joint targets", "joint targets", "none"]);
    }
    assert_eq!(field_of(steering, f32::INFINITY), "numbers");
    // The variant of a rise, and two bytes of its share.
    assert_eq!(field_of(len, f32::from_bits(0x0000_ffff)), "rising variant");
}

#[test]
fn a_state_whose_times_were_counted_for_hours_is_read() {
    let pack = Arc::new(common::pack(-4.0));
    let config = ControllerConfig {
        auto_recover: false,
        settle_secs: 1e9,
        handover_secs: f32::INFINITY,
        start: n(1),
        ..config()
    };
    let mut controller = Controller::with_config(pack.clone(), config);
    let roll = Command { skill: pack.skill_named("roll"), ..Command::default() };
    controller.tick(&standing(), &roll, DT);
    while controller.report().skill.is_some() {
        controller.tick(&standing(), &Command::default(), 0.25);
    }
    let [saved, read] = common::saved_and_read(&controller);
    assert_eq!(read, saved, "a time that a game chose");
    let mut lying = standing();
    lying.bodies[0].position.z = 0.2;
    for _ in 0..5 * 3600 {
        controller.tick(&lying, &Command::default(), 0.25);
    }
    assert!(controller.report().fallen);
    let [saved, read] = common::saved_and_read(&controller);
    assert_eq!(read, saved);
}

#[test]
fn a_state_of_another_pack_is_refused_and_changes_nothing() {
    let mut small = common::manifest();
    (small.skills, small.recovery) = (Vec::new(), None);
    let small = CharacterPack::from_parts(small, common::tensors(0.0)).unwrap();
    let pack = Arc::new(common::pack(0.0));
    let mut running = Controller::new(pack.clone());
    running.tick(&standing(), &Command { skill: pack.skill_named("get_up"), ..Command::default() }, DT);
    let roll = Command { skill: pack.skill_named("roll"), ..Command::default() };
    running.place_at(policy_core::GraphPosition::node(n(1)));
    running.tick(&standing(), &roll, DT);
    let mut state = ControllerState::new(&pack);
    running.save_into(&mut state);
    let mut without = Controller::new(Arc::new(small));
    let before = *without.report();
    assert!(matches!(without.restore(&state), Err(StateError::Field { field: "skill", .. })));
    assert_eq!(*without.report(), before);
}

#[test]
fn a_hand_over_passes_from_the_old_targets_to_the_new_policy() {
    let pack = Arc::new(common::pack(-4.0));
    let roll = Command { skill: pack.skill_named("roll"), ..Command::default() };
    let start = pack.graph().node_named("walk").unwrap();
    let jumps = |handover_secs: f32| {
        let config = ControllerConfig { handover_secs, start, ..ControllerConfig::default() };
        let mut controller = Controller::with_config(pack.clone(), config);
        let mut before = controller.tick(&standing(), &Command::default(), DT).to_vec();
        let mut largest = Vec::new();
        for _ in 0..8 {
            let now = controller.tick(&standing(), &roll, DT).to_vec();
            largest.push(now.iter().zip(&before).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max));
            before = now;
        }
        (largest.iter().copied().fold(0.0, f32::max), before)
    };
    let ((jump, there), (blended, same)) = (jumps(0.0), jumps(0.15));
    assert!(blended < 0.4 * jump, "{blended} against {jump}");
    assert_eq!(there, same, "it ends at the policy's own targets");
}

#[test]
fn wrong_sizes_and_wrong_rates_are_reported() {
    let pack = Arc::new(common::pack(0.0));
    let mut controller = Controller::new(pack);
    let mut short = standing();
    short.bodies.pop();
    assert_eq!(controller.tick(&short, &Command::default(), DT).len(), 28);
    assert_eq!(controller.report().fault, Some(StateFault::WrongSize));
    for (dt, off) in [(DT, false), (1.0 / 36.0, false), (1.0 / 60.0, true), (0.1, true), (f32::NAN, true)] {
        controller.tick(&standing(), &Command::default(), dt);
        assert_eq!((controller.report().off_rate, controller.report().fault), (off, None), "{dt}");
    }
}

#[test]
fn turn_assist_slows_fast_gaits_down_and_leaves_low_gaits() {
    let (mut manifest, tensors) = (common::manifest(), common::tensors(0.0));
    let speeds = [0.0, 1.25, 2.8, 3.5, 0.4, 0.3];
    manifest.policies.iter_mut().zip(speeds).for_each(|(p, speed)| p.speed_mps = Some(speed));
    let upright = CharacterPack::from_parts(manifest.clone(), tensors.clone()).unwrap();
    manifest.policies[4].fall_height = Some(0.4);
    let pack = CharacterPack::from_parts(manifest, tensors).unwrap();
    let coordinate = |path: usize, coordinate: f32, target: Vec2| {
        let goal = Goal::Path { path: PathId::new(path), coordinate };
        let command = Command { target: Some(target), goal, ..Command::default() };
        let adjusted = TurnAssist::default().adjusted(pack.graph(), &standing(), &command);
        let coordinate = match adjusted.goal {
            Goal::Path { coordinate, .. } => coordinate,
            _ => f32::NAN,
        };
        (coordinate, adjusted.target.unwrap())
    };
    let further = |path, at, target| coordinate(path, at, target).1;
    let coordinate = |path, at, target| coordinate(path, at, target).0;
    let (ahead, aside, behind) = (Vec2::new(5.0, 0.0), Vec2::new(3.5, 3.5), Vec2::new(-5.0, 0.1));
    assert_eq!([ahead, behind].map(|t| coordinate(0, 3.0, t)), [3.0, 1.0]);
    assert!((1.2..2.9).contains(&coordinate(0, 3.0, aside)));
    assert_eq!([ahead, behind].map(|t| coordinate(0, 0.4, t)), [0.4, 1.0]);
    assert_eq!([1.5, 2.0, 3.0].map(|c| coordinate(1, c, behind)), [1.5, 2.0, 3.0], "a crouch stays a crouch");
    let goal = Goal::Path { path: PathId::new(1), coordinate: 2.0 };
    let command = Command { target: Some(behind), goal, ..Command::default() };
    let turning = Goal::Path { path: PathId::new(1), coordinate: 1.0 };
    let adjusted = TurnAssist::default().adjusted(upright.graph(), &standing(), &command);
    assert_eq!(adjusted.goal, turning, "a slow gait that stands as high turns as the other");
    assert_eq!(coordinate(0, 3.0, Vec2::ZERO), 3.0);
    // As if the stick were pushed as far as the coordinate is raised.
    assert_eq!([0.5, 1.0, 3.0].map(|c| further(0, c, behind)), [2.0 * behind, behind, behind]);
    assert_eq!(further(0, 0.5, ahead), ahead);
    assert_eq!(further(0, 0.0, behind), 5.0 * behind, "bounded at a coordinate of zero");
}

#[test]
fn the_mode_of_a_controller_decides_how_it_blends() {
    let pack = Arc::new(common::pack(0.0));
    let goal = Goal::Path { path: PathId::new(0), coordinate: 1.5 };
    let mut controller = Controller::new(pack);
    for _ in 0..60 {
        controller.tick(&standing(), &Command { goal, ..Command::default() }, DT);
    }
    let parameters = bits(&controller);
    let mut seen = Vec::new();
    for mode in BlendMode::ALL {
        controller.set_blend_mode(mode);
        controller.tick(&standing(), &Command { goal, ..Command::default() }, DT);
        seen.push(bits(&controller));
    }
    assert!(seen[0] == parameters && seen[1] != parameters && seen[2] != seen[1]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn any_bytes_are_refused_or_give_a_controller_that_ticks(
        changes in prop::collection::vec((0.0f64..1.0, any::<u8>()), 1..12),
    ) {
        let pack = Arc::new(common::pack(0.3));
        let mut controller = Controller::with_config(pack.clone(), config());
        for tick in 80..110 {
            let (body, command) = tick_of(tick);
            controller.tick(&body, &command, DT);
        }
        let mut state = ControllerState::new(&pack);
        controller.save_into(&mut state);
        let mut bytes = vec![0; state.byte_len()];
        state.write_bytes(&mut bytes);
        for (at, value) in changes {
            let at = (at * bytes.len() as f64) as usize;
            bytes[at] = value;
        }
        if state.read_bytes(&pack, &bytes).is_ok() {
            controller.restore(&state).unwrap();
            for tick in 110..125 {
                let (body, command) = tick_of(tick);
                let targets = controller.tick(&body, &command, DT);
                prop_assert!(targets.iter().all(|t| t.is_finite()));
            }
        }
    }
}

#[test]
fn manifests_differ_only_in_their_checksum_after_a_round_trip() {
    let (mut manifest, tensors) = (common::manifest(), common::tensors(0.5));
    manifest.discriminators[0].storage = policy_core::format::Storage::F16;
    let pack = CharacterPack::from_parts(manifest.clone(), tensors).unwrap();
    let read = CharacterPack::from_bytes(&pack.to_bytes()).unwrap();
    assert_eq!(Manifest { checksum: None, ..read.manifest().clone() }, manifest);
    assert_eq!(read.tensors(), pack.tensors(), "zeros and 0.5 are exact in 16 bits");
    assert_eq!(read.to_bytes(), pack.to_bytes());
}
