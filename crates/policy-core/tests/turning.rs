//! Turns: from the moment in which the target of a character that goes lies far aside until it goes there, its gaits give all of their weight to
//! their turning variant.

mod common;

use std::sync::Arc;

use common::{hand_over, moving, policy, weight_of};
use glam::{Quat, Vec2, Vec3};
use policy_core::{CharacterPack, CharacterState, Command, Controller, ControllerConfig, Goal, PathId};

const DT: f32 = 1.0 / 30.0;

/// The turning variant in the made-up pack.
const TURNS: &str = "roll";

/// It stands at `idle`, walks at 1 m/s, jogs at 2 m/s and crouches at 0.4 m/s; a crouch has no turning variant.
fn pack() -> Arc<CharacterPack> {
    let manifest = common::gaits(|gait| gait.turning = Some(TURNS.into()));
    Arc::new(CharacterPack::from_parts(manifest, common::tensors(0.0)).unwrap())
}

/// Where the body faces and goes, degrees to the left of x, and how fast it goes there, metres per second.
#[derive(Clone, Copy)]
struct Moves {
    faces: f32,
    goes: f32,
    speed: f32,
}

const AHEAD: Moves = Moves { faces: 0.0, goes: 0.0, speed: 1.0 };

fn state(moves: Moves) -> CharacterState {
    let turned = |degrees: f32| Quat::from_rotation_z(degrees.to_radians());
    let mut state = moving(turned(moves.goes) * Vec3::X * moves.speed);
    state.bodies[0].rotation = turned(moves.faces);
    state
}

/// One tick of a body that moves so and is to go to a side, degrees. Returns the share of the turning variant.
fn share(controller: &mut Controller, moves: Moves, path: usize, coordinate: f32, way: Option<f32>) -> f32 {
    let goal = Goal::Path { path: PathId::new(path), coordinate };
    let target = way.map(|degrees| Vec2::from_angle(degrees.to_radians()) * 10.0);
    controller.tick(&state(moves), &Command { goal, target, ..Command::default() }, DT);
    weight_of(controller, TURNS)
}

/// A controller of a character that has gone ahead for two seconds.
fn goes(path: usize, coordinate: f32, speed: f32) -> Controller {
    let config = ControllerConfig { give_way: None, turn_assist: None, ..ControllerConfig::default() };
    let mut controller = Controller::with_config(pack(), config);
    let moves = Moves { speed, ..AHEAD };
    (0..60).for_each(|_| assert_eq!(share(&mut controller, moves, path, coordinate, Some(0.0)), 0.0));
    controller
}

/// A controller of a character that crawls at 0.3 m/s, with these variants.
fn crawls(turning: Option<&str>, steady: Option<&str>) -> Controller {
    let mut manifest = common::gaits(|_| ());
    let crawl = &mut manifest.policies[policy("crawl")];
    crawl.speed_mps = Some(0.3);
    (crawl.turning, crawl.steady) = (turning.map(Into::into), steady.map(Into::into));
    let pack = Arc::new(CharacterPack::from_parts(manifest, common::tensors(0.0)).unwrap());
    Controller::with_config(pack, ControllerConfig { give_way: None, ..ControllerConfig::default() })
}

#[test]
fn it_takes_all_in_the_tick_in_which_the_target_lies_far_aside_until_the_character_goes_there() {
    for (coordinate, speed) in [(1.0, 1.0), (2.0, 2.0), (0.5, 0.5)] {
        let mut controller = goes(0, coordinate, speed);
        let mut at =
            |faces, goes| share(&mut controller, Moves { faces, goes, speed }, 0, coordinate, Some(90.0));
        for (faces, goes) in [(0.0, 0.0), (50.0, 20.0), (60.0, 70.0), (85.0, 70.0), (60.0, 90.0)] {
            assert_eq!(at(faces, goes), 1.0, "it faces {faces} and goes {goes} degrees at {speed} m/s");
        }
        let shares: Vec<f32> = (0..13).map(|_| at(75.0, 82.0)).collect();
        assert!((shares[0] - (1.0 - DT / 0.4)).abs() < 1e-5 && shares[12] < 1e-6, "0.4 s back: {shares:?}");
        assert_eq!(at(60.0, 60.0), 0.0, "30 degrees off are no turn");
    }
}

#[test]
fn slow_characters_small_angles_and_low_gaits_have_none() {
    assert_eq!(share(&mut goes(0, 1.0, 1.0), AHEAD, 0, 1.0, Some(30.0)), 0.0, "the target is nearly ahead");
    assert_eq!(share(&mut goes(0, 1.0, 1.0), AHEAD, 0, 1.0, Some(35.0)), 1.0);
    let mut pushed = goes(0, 1.0, 1.0);
    for faces in [0.0, 30.0, 60.0, 90.0] {
        let turned = Moves { faces, goes: 90.0, speed: 1.0 };
        assert_eq!(share(&mut pushed, turned, 0, 1.0, Some(0.0)), 0.0, "a push has turned it");
    }
    assert_eq!(share(&mut pushed, AHEAD, 0, 1.0, Some(90.0)), 1.0);
    assert_eq!(share(&mut goes(0, 1.0, 0.3), Moves { speed: 0.3, ..AHEAD }, 0, 1.0, Some(90.0)), 0.0);
    assert_eq!(share(&mut goes(0, 1.0, 1.0), AHEAD, 0, 0.0, None), 0.0, "told to stand, it stops");
    let mut low = goes(1, 2.0, 0.5);
    assert_eq!(share(&mut low, AHEAD, 1, 2.0, Some(90.0)), 0.0, "a crouch");
    (0..3).for_each(|_| assert_eq!(share(&mut low, AHEAD, 1, 1.0, Some(90.0)), 0.0, "out of a crouch"));
}

/// Where the policy sees its target, degrees to the left of the heading.
fn target_seen(controller: &Controller) -> f32 {
    let [x, y] = controller.report().target;
    y.atan2(x).to_degrees()
}

#[test]
fn what_a_gait_is_trimmed_by_is_none_of_the_turning_variants_business() {
    let seen = |controller: &mut Controller, moves, way| {
        share(controller, moves, 0, 1.0, Some(way));
        target_seen(controller)
    };
    for way in [45.0, -45.0] {
        let [mut drifted, mut straight] = [goes(0, 1.0, 1.0), goes(0, 1.0, 1.0)];
        let drifts = Moves { goes: 12.0, ..AHEAD };
        let asked: Vec<f32> = (0..30).map(|_| seen(&mut drifted, drifts, 0.0)).collect();
        assert!(asked[29] < asked[0] - 5.0, "the trim grows to the right: {asked:?}");
        let [trimmed, plain] = [&mut drifted, &mut straight].map(|c| seen(c, AHEAD, way));
        assert!((trimmed - plain).abs() < 0.1, "{trimmed} and {plain} degrees, turning by {way}");
    }
}

#[test]
fn a_gait_slower_than_that_turns_on_the_spot_until_it_faces_its_target() {
    let mut controller = crawls(Some(TURNS), None);
    let slow = Moves { speed: 0.05, ..AHEAD };
    let mut at = |moves, way| share(&mut controller, moves, 1, 3.0, Some(way));
    (0..120).for_each(|_| assert_eq!(at(slow, 35.0), 0.0, "a small angle"));
    for faces in [0.0, 45.0, 70.0] {
        assert_eq!(at(Moves { faces, ..slow }, 90.0), 1.0, "it faces {faces} degrees and hardly moves");
    }
    let shares: Vec<f32> = (0..13).map(|_| at(Moves { faces: 80.0, goes: 30.0, speed: 0.3 }, 90.0)).collect();
    assert!((shares[0] - (1.0 - DT / 0.4)).abs() < 1e-5 && shares[12] < 1e-6, "wherever it goes: {shares:?}");
    assert_eq!(at(Moves { faces: 140.0, ..slow }, 90.0), 0.0, "it sways");
    assert_eq!(at(Moves { faces: 165.0, ..slow }, 90.0), 1.0, "a push has turned it");
    (0..13).for_each(|_| _ = at(Moves { faces: 90.0, ..slow }, 90.0));
    assert_eq!(
        at(Moves { faces: 98.0, ..slow }, 112.0),
        1.0,
        "the way has changed, and it sways that way already"
    );
}

#[test]
fn a_gait_that_turns_on_the_spot_gets_no_trim_and_while_it_turns_no_lead() {
    let sees = |turning: Option<&str>| -> [f32; 2] {
        let mut controller = crawls(turning, None);
        let mut at = |goes: f32, way: f32| {
            share(&mut controller, Moves { goes, speed: 0.3, ..AHEAD }, 1, 3.0, Some(way));
            target_seen(&controller)
        };
        (0..120).for_each(|_| _ = at(0.0, 0.0));
        (0..60).for_each(|_| _ = at(10.0, 0.0));
        [at(10.0, 0.0), at(10.0, 60.0)]
    };
    let [ahead, aside] = sees(Some(TURNS));
    assert!(
        (ahead + 5.0).abs() < 0.2 && (aside - 60.0).abs() < 0.1,
        "half the error, then none: {ahead}, {aside}"
    );
    let [ahead, aside] = sees(None);
    assert!(ahead < -15.0 && aside > 62.0, "a gait that can't turn gets both: {ahead}, {aside}");
}

#[test]
fn a_gait_that_turns_on_the_spot_comes_out_of_its_turn_by_its_steady_variant() {
    const STEADY: &str = "walk";
    let mut controller = crawls(Some(TURNS), Some(STEADY));
    let mut shares = |ticks: usize, faces: f32, way: f32| -> Vec<[f32; 2]> {
        let moves = Moves { faces, goes: faces, speed: 0.3 };
        let mut acts = || {
            let turns = share(&mut controller, moves, 1, 3.0, Some(way));
            [turns, weight_of(&controller, STEADY)]
        };
        (0..ticks).map(|_| acts()).collect()
    };
    assert_eq!(shares(240, 0.0, 0.0)[239], [0.0, 1.0], "it goes ahead");
    assert_eq!(shares(30, 20.0, 90.0)[29], [1.0, 0.0], "in a turn");
    let out = shares(14, 88.0, 90.0);
    assert!(out.iter().all(|[turns, steady]| (turns + steady - 1.0).abs() < 1e-5), "{out:?}");
    assert!(out[5][1] > 0.3 && out[13] == [0.0, 1.0], "{out:?}");
}

#[test]
fn a_saved_state_goes_on_with_its_turn() {
    let mut controller = goes(0, 1.0, 1.0);
    share(&mut controller, AHEAD, 0, 1.0, Some(120.0));
    let mut other = goes(0, 2.0, 2.0);
    hand_over(&controller, &mut other);
    for faces in [20.0, 60.0, 95.0, 110.0, 118.0, 118.0] {
        let moves = Moves { faces, goes: faces, speed: 0.7 };
        let shares = [&mut controller, &mut other].map(|c| share(c, moves, 0, 1.0, Some(120.0)));
        assert!(shares[0] == shares[1] && shares[0] > 0.0);
        assert_eq!(controller.report(), other.report());
    }
}

#[test]
fn what_a_turn_takes_of_the_speed_is_nothing_that_holds_the_character_up() {
    let goal = Goal::Path { path: PathId::new(0), coordinate: 1.0 };
    let mut controller = Controller::with_config(
        pack(),
        ControllerConfig { turn_assist: None, ..ControllerConfig::default() },
    );
    let mut tick = |moves: Moves, degrees: f32| {
        let target = Some(Vec2::from_angle(degrees.to_radians()) * 10.0);
        controller.tick(&state(moves), &Command { goal, target, ..Command::default() }, DT);
        controller.report().goal.as_node().map(|node| node.index())
    };
    for _ in 0..60 {
        assert_eq!(tick(AHEAD, 0.0), Some(policy("walk")));
    }
    // It faces its target while it still goes aside, then goes there slowly.
    for faces in [30.0, 60.0, 90.0, 110.0, 110.0, 110.0, 110.0, 110.0] {
        assert_eq!(tick(Moves { faces, goes: 70.0, speed: 0.8 }, 135.0), Some(policy("walk")), "at {faces}");
    }
    for _ in 0..30 {
        assert_eq!(tick(Moves { faces: 135.0, goes: 130.0, speed: 0.4 }, 135.0), Some(policy("walk")));
    }
}
