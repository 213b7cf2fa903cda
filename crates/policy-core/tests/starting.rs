//! Starts: while a character sets off from a stand its gaits give all of their weight to their starting variant.

mod common;

use std::sync::Arc;

use common::{hand_over, moving, policy, weight_of};
use glam::{Vec2, Vec3};
use policy_core::{
    CharacterPack, CharacterState, Command, Controller, ControllerConfig, GiveWay, Goal, PathId,
};

const DT: f32 = 1.0 / 30.0;

/// The starting variant in the made-up pack, and the speed up to which it acts, metres per second.
const STARTS: (&str, f32) = ("roll", 0.8);

/// It stands at `idle`, walks at 1 m/s, jogs at 2 m/s and crouches at 0.4 m/s.
fn pack() -> Arc<CharacterPack> {
    let mut manifest = common::gaits(|gait| gait.starting = Some(STARTS.0.into()));
    manifest.policies[policy(STARTS.0)].speed_mps = Some(STARTS.1);
    Arc::new(CharacterPack::from_parts(manifest, common::tensors(0.0)).unwrap())
}

/// A controller of a character that has stood for so many ticks, with nothing asked.
fn stood(ticks: usize) -> Controller {
    let config = ControllerConfig { give_way: None, ..ControllerConfig::default() };
    let mut controller = Controller::with_config(pack(), config);
    (0..ticks).for_each(|_| assert_eq!(tick(&mut controller, 0.0, None), 0.0));
    controller
}

/// The same after a second.
fn stands() -> Controller {
    stood(30)
}

/// One tick at a speed ahead; asked to go on to a coordinate of the first path, or to stand. Returns the share of the starting variant.
fn tick(controller: &mut Controller, speed: f32, coordinate: Option<f32>) -> f32 {
    share(controller, &moving(Vec3::X * speed), PathId::new(0), coordinate)
}

fn share(controller: &mut Controller, state: &CharacterState, path: PathId, coordinate: Option<f32>) -> f32 {
    let target = coordinate.map(|_| Vec2::X * 10.0);
    let goal = Goal::Path { path, coordinate: coordinate.unwrap_or_default() };
    controller.tick(state, &Command { goal, target, ..Command::default() }, DT);
    weight_of(controller, STARTS.0)
}

#[test]
fn it_takes_all_at_once_and_leaves_off_as_soon_as_the_character_is_as_fast_as_that() {
    for coordinate in [1.0, 2.0] {
        let mut controller = stands();
        for speed in [0.0, 0.0, 0.2, 0.5, 0.7] {
            assert_eq!(tick(&mut controller, speed, Some(coordinate)), 1.0, "to {coordinate} at {speed} m/s");
        }
        let shares: Vec<f32> = (0..6).map(|_| tick(&mut controller, 0.85, Some(coordinate))).collect();
        assert!((shares[0] - (1.0 - DT / 0.2)).abs() < 1e-5 && shares[5] < 1e-6, "0.2 s back: {shares:?}");
        assert_eq!(tick(&mut controller, 0.3, Some(coordinate)), 0.0, "slowed down on its way: no start");
    }
}

#[test]
fn a_start_takes_a_second_at_most() {
    let mut controller = stands();
    let ticks = (0..90).take_while(|_| tick(&mut controller, 0.1, Some(1.0)) == 1.0).count();
    assert!((28..=30).contains(&ticks), "{ticks} ticks");
    assert_eq!((0..7).map(|_| tick(&mut controller, 0.1, Some(1.0))).last(), Some(0.0));
    (0..60).for_each(|_| _ = tick(&mut controller, 0.0, None));
    assert_eq!(tick(&mut controller, 0.0, Some(1.0)), 1.0, "it stood again");
}

#[test]
fn slow_gaits_light_sticks_and_characters_that_move_have_none() {
    assert_eq!(tick(&mut stands(), 0.0, Some(0.4)), 0.0, "a light stick");
    let mut down = stands();
    assert_eq!(share(&mut down, &moving(Vec3::ZERO), PathId::new(1), Some(2.0)), 0.0, "down to a crouch");
    let mut controller = stood(0);
    (0..60).for_each(|_| assert_eq!(tick(&mut controller, 0.6, None), 0.0, "it does not stand still"));
    assert_eq!(tick(&mut controller, 0.6, Some(1.0)), 0.0);
    assert_eq!(tick(&mut stood(8), 0.0, Some(1.0)), 0.0, "it has hardly come to a stand");
    let mut brakes = stands();
    tick(&mut brakes, 0.0, Some(1.0));
    (0..7).for_each(|_| _ = tick(&mut brakes, 0.5, None));
    assert_eq!(tick(&mut brakes, 0.5, None), 0.0, "told to stop, it stops");
}

#[test]
fn what_held_a_character_up_is_no_start() {
    let give_way = Some(GiveWay { stop_secs: 2.0, ..GiveWay::default() });
    let config = ControllerConfig { give_way, ..ControllerConfig::default() };
    let mut controller = Controller::with_config(pack(), config);
    (0..60).for_each(|_| _ = tick(&mut controller, 1.0, Some(1.0)));
    let shares: Vec<f32> = (0..120).map(|_| tick(&mut controller, 0.0, Some(1.0))).collect();
    assert!(shares.iter().all(|share| *share == 0.0), "it gives way, stands and pushes on: {shares:?}");
}

#[test]
fn a_saved_state_goes_on_with_its_start() {
    let mut controller = stands();
    tick(&mut controller, 0.0, Some(1.0));
    let mut other = stood(0);
    hand_over(&controller, &mut other);
    for speed in [0.3, 0.6, 0.9, 0.9] {
        let shares = [&mut controller, &mut other].map(|c| tick(c, speed, Some(1.0)));
        assert!(shares[0] == shares[1] && shares[0] > 0.0);
        assert_eq!(controller.report(), other.report());
    }
}
