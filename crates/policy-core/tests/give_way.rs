//! Giving way: a character that something holds up stands for a moment, and only then.

mod common;

use std::sync::Arc;

use common::standing;
use policy_core::glam::{Quat, Vec2, Vec3};
use policy_core::{
    CharacterPack, Command, Controller, ControllerConfig, ControllerState, GiveWay, Goal, PathId,
};

const DT: f32 = 1.0 / 30.0;

fn controller(give_way: Option<GiveWay>) -> Controller {
    let config = ControllerConfig { give_way, ..ControllerConfig::default() };
    let mut manifest = common::manifest();
    for (policy, speed_mps) in manifest.policies.iter_mut().zip([0.0, 1.0, 2.0]) {
        policy.speed_mps = Some(speed_mps);
    }
    let pack = CharacterPack::from_parts(manifest, common::tensors(0.0)).unwrap();
    Controller::with_config(Arc::new(pack), config)
}

/// One tick along x at a speed, asked to go that way at a coordinate. True when the controller goes to where the path begins.
fn stands(controller: &mut Controller, speed_mps: f32, coordinate: f32) -> bool {
    stands_turned(controller, (speed_mps, 0.0), coordinate)
}

fn stands_turned(controller: &mut Controller, (speed_mps, heading): (f32, f32), coordinate: f32) -> bool {
    let mut state = standing();
    state.bodies[0].linear_velocity = Vec3::X * speed_mps;
    state.bodies[0].rotation = Quat::from_rotation_z(heading);
    let goal = Goal::Path { path: PathId::new(0), coordinate };
    let command = Command { goal, target: Some(Vec2::X * 5.0), ..Command::default() };
    controller.tick(&state, &command, DT);
    controller.report().goal
        == Goal::Path { path: PathId::new(0), coordinate: 0.0 }.position(controller.pack().graph()).unwrap()
}

fn walking(give_way: Option<GiveWay>) -> Controller {
    let mut controller = controller(give_way);
    for _ in 0..30 {
        assert!(!stands(&mut controller, 1.0, 1.0), "nothing holds it up");
    }
    controller
}

#[test]
fn what_is_held_up_stands_for_its_time_and_then_pushes_on() {
    let mut controller = walking(Some(GiveWay::default()));
    let ticks: Vec<bool> = (0..90).map(|_| stands(&mut controller, 0.1, 1.0)).collect();
    let first = ticks.iter().position(|stands| *stands).unwrap();
    let count = ticks.iter().filter(|stands| **stands).count();
    assert!((1..=5).contains(&first), "after {first} ticks");
    assert!((20..=22).contains(&count), "for 0.7 s, not {count} ticks");
    assert!(ticks[first + count..].iter().all(|stands| !stands), "it pushes on from a stand");
}

#[test]
fn a_start_a_slower_command_and_a_turn_are_no_obstacles() {
    let mut start = controller(Some(GiveWay::default()));
    assert!((0..60).all(|tick| !stands(&mut start, 0.9 * (tick as f32 / 60.0), 1.0)));
    let mut slower = walking(Some(GiveWay::default()));
    assert!((0..60).all(|_| !stands(&mut slower, 0.3, 0.35)), "it was asked for less");
    let mut turning = walking(Some(GiveWay::default()));
    assert!((0..60).all(|_| !stands_turned(&mut turning, (-0.5, 2.0), 1.0)));
    let mut off = walking(None);
    assert!((0..60).all(|_| !stands(&mut off, 0.1, 1.0)));
}

#[test]
fn a_character_saved_while_it_gives_way_goes_on_giving_way() {
    let mut controller = walking(Some(GiveWay::default()));
    while !stands(&mut controller, 0.1, 1.0) {}
    let mut state = ControllerState::new(controller.pack());
    controller.save_into(&mut state);
    let mut bytes = vec![0; state.byte_len()];
    state.write_bytes(&mut bytes);
    let mut other = walking(Some(GiveWay::default()));
    let pack = Arc::clone(other.pack());
    state.read_bytes(&pack, &bytes).unwrap();
    other.restore(&state).unwrap();
    for _ in 0..40 {
        assert_eq!(stands(&mut other, 0.1, 1.0), stands(&mut controller, 0.1, 1.0));
    }
}
