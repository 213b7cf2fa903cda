//! Catches: where a push drives a character that goes off its course, its gaits give all of their weight to their catching variant for a moment.

mod common;

use std::sync::Arc;

use common::{acted, hand_over, moving, n, weight_of};
use glam::{Quat, Vec2, Vec3};
use policy_core::{
    Blend, CharacterPack, CharacterState, Command, Controller, ControllerConfig, Goal, GraphPosition, PathId,
    PolicyId, Skeleton,
};

const DT: f32 = 1.0 / 30.0;

/// The catching variant in the made-up pack.
const CATCHES: &str = "roll";

/// Ticks for which a catch goes on after the body was last off its course.
const SETTLES_TICKS: usize = 18;

/// It stands at `idle`, walks at 1 m/s, jogs at 2 m/s and crouches at 0.4 m/s; a crouch has no catching variant.
fn pack() -> Arc<CharacterPack> {
    let manifest = common::gaits(|gait| gait.catching = Some(CATCHES.into()));
    Arc::new(CharacterPack::from_parts(manifest, common::tensors(0.0)).unwrap())
}

/// A controller of a character that has gone at its pace for a second.
fn goes(coordinate: f32, speed: f32, capture_steps: bool) -> Controller {
    let config =
        ControllerConfig { capture_steps, start: n(1), give_way: None, ..ControllerConfig::default() };
    let mut controller = Controller::with_config(pack(), config);
    for _ in 0..60 {
        assert_eq!(share(&mut controller, coordinate, &moving(Vec3::X * speed)), 0.0);
    }
    controller
}

/// One tick on *speed* with a target ahead. Returns the share of the catching variant.
fn share(controller: &mut Controller, coordinate: f32, state: &CharacterState) -> f32 {
    share_towards(controller, coordinate, state, Vec2::X * 10.0)
}

/// The same with a target anywhere.
fn share_towards(controller: &mut Controller, coordinate: f32, state: &CharacterState, target: Vec2) -> f32 {
    let goal = Goal::Path { path: PathId::new(0), coordinate };
    controller.tick(state, &Command { goal, target: Some(target), ..Command::default() }, DT);
    weight_of(controller, CATCHES)
}

#[test]
fn it_takes_all_in_the_tick_in_which_a_push_drives_the_body_off_its_course_and_for_a_moment_after_it() {
    // Half a stick, a walk, a jog: 0.46, 0.52 and 0.64 m/s aside or too fast are a push.
    for (coordinate, speed, most) in [(0.5, 0.5, 0.46), (1.0, 1.0, 0.52), (2.0, 2.0, 0.64)] {
        for side in [Vec3::Y, Vec3::NEG_Y, Vec3::X] {
            let mut controller = goes(coordinate, speed, true);
            let driven = |off: f32| moving(Vec3::X * speed + side * off);
            assert_eq!(share(&mut controller, coordinate, &driven(0.9 * most)), 0.0, "it sways at {speed}");
            assert_eq!(share(&mut controller, coordinate, &driven(1.1 * most)), 1.0, "{side} at {speed}");
            assert!(controller.report().target[0] > 0.0, "it goes on towards its target");
            let catches = (0..60).take_while(|_| share(&mut controller, coordinate, &driven(0.0)) == 1.0);
            let catches = catches.count();
            assert!((SETTLES_TICKS - 2..=SETTLES_TICKS).contains(&catches), "{catches} ticks");
            let last = (0..6).map(|_| share(&mut controller, coordinate, &driven(0.0))).last();
            assert_eq!(last, Some(0.0));
        }
    }
}

#[test]
fn a_stick_that_is_pushed_a_little_aside_is_no_push_until_the_body_faces_that_way() {
    for degrees in [22.0_f32, 30.0, -30.0] {
        let mut controller = goes(2.0, 2.0, true);
        let way = Vec2::from_angle(degrees.to_radians());
        let mut towards = |state: &CharacterState| share_towards(&mut controller, 2.0, state, 10.0 * way);
        (0..15).for_each(|tick| {
            assert_eq!(towards(&moving(Vec3::X * 2.0)), 0.0, "{degrees} degrees, tick {tick}");
        });
        let turned = |aside: f32| {
            let mut state = moving((2.0 * way + aside * way.perp()).extend(0.0));
            state.bodies[0].rotation = Quat::from_rotation_z(degrees.to_radians());
            state
        };
        (0..30).for_each(|_| assert_eq!(towards(&turned(0.0)), 0.0, "it goes there"));
        assert_eq!(towards(&turned(0.8)), 1.0, "that is a push");
    }
}

#[test]
fn the_speed_of_the_variant_itself_is_no_push() {
    let mut manifest = common::gaits(|gait| gait.catching = Some(CATCHES.into()));
    manifest.policies[common::policy(CATCHES)].speed_mps = Some(1.6);
    let pack = Arc::new(CharacterPack::from_parts(manifest, common::tensors(0.0)).unwrap());
    let config = ControllerConfig { start: n(1), give_way: None, ..ControllerConfig::default() };
    let mut controller = Controller::with_config(pack, config);
    (0..60).for_each(|_| assert_eq!(share(&mut controller, 1.0, &moving(Vec3::X)), 0.0));
    let own = moving(Vec3::X * 1.6);
    assert_eq!(share(&mut controller, 1.0, &moving(Vec3::new(1.0, 1.0, 0.0))), 1.0);
    let catches = (0..60).take_while(|_| share(&mut controller, 1.0, &own) > 0.0).count();
    assert!((SETTLES_TICKS..=SETTLES_TICKS + 6).contains(&catches), "{catches} ticks");
    (0..30).for_each(|_| assert_eq!(share(&mut controller, 1.0, &own), 0.0, "it brakes by itself"));
    assert_eq!(share(&mut controller, 1.0, &moving(Vec3::X * 2.2)), 1.0, "that is a push");
}

#[test]
fn a_gait_faster_than_the_variant_is_caught_where_a_push_holds_it_back() {
    let mut manifest = common::gaits(|gait| gait.catching = Some(CATCHES.into()));
    manifest.policies[common::policy(CATCHES)].speed_mps = Some(1.6);
    let pack = Arc::new(CharacterPack::from_parts(manifest, common::tensors(0.0)).unwrap());
    // A jog is 0.64 m/s slower than the variant at 0.96 m/s. A walk is never as fast as the variant.
    for (coordinate, speed, slow, caught) in
        [(2.0, 2.0, 1.0, 0.0), (2.0, 2.0, 0.9, 1.0), (1.0, 1.0, 0.3, 0.0)]
    {
        let config = ControllerConfig { start: n(1), give_way: None, ..ControllerConfig::default() };
        let mut controller = Controller::with_config(pack.clone(), config);
        let paces = (0..90).map(|_| share(&mut controller, coordinate, &moving(Vec3::X * speed))).last();
        assert_eq!(paces, Some(0.0));
        assert_eq!(share(&mut controller, coordinate, &moving(Vec3::X * slow)), caught, "{slow} of {speed}");
        let again = (0..60).map(|_| share(&mut controller, coordinate, &moving(Vec3::X * 1.5))).last();
        assert_eq!(again, Some(0.0), "it gathers speed by itself");
    }
}

#[test]
fn a_gait_without_a_turning_variant_is_not_caught_while_it_turns() {
    let aside = moving(Vec3::new(1.0, 1.0, 0.0));
    let about = share_towards(&mut goes(1.0, 1.0, true), 1.0, &aside, Vec2::X * -10.0);
    assert_eq!(about, 0.0, "it is to turn about, and leans");
    assert_eq!(share(&mut goes(1.0, 1.0, true), 1.0, &aside), 1.0, "it goes on, and was pushed");
}

#[test]
fn the_trunk_alone_or_the_hips_alone_count_by_half() {
    let skeleton = Skeleton::humanoid();
    for body in [skeleton.root(), skeleton.head().unwrap()] {
        let mut controller = goes(1.0, 1.0, true);
        let mut state = moving(Vec3::X);
        state.body_mut(body).linear_velocity.y = 0.9;
        assert_eq!(share(&mut controller, 1.0, &state), 0.0);
        state.body_mut(body).linear_velocity.y = 1.2;
        assert_eq!(share(&mut controller, 1.0, &state), 1.0);
    }
}

#[test]
fn starts_rough_ground_stands_and_gaits_without_a_variant_are_left_alone() {
    let pushed = moving(Vec3::new(1.0, 1.2, 0.0));
    let config = ControllerConfig { start: n(1), ..ControllerConfig::default() };
    let mut starts = Controller::with_config(pack(), config);
    assert_eq!(share(&mut starts, 1.0, &pushed), 0.0, "it has not gone at its pace yet");
    assert_eq!(share(&mut goes(1.0, 1.0, false), 1.0, &pushed), 0.0, "switched off");
    let mut rough = goes(1.0, 1.0, true);
    let uneven = |mut state: CharacterState| {
        state.ground_rises[Skeleton::humanoid().feet()[0].index()] = 0.2;
        state
    };
    (0..15).for_each(|_| assert_eq!(share(&mut rough, 1.0, &uneven(moving(Vec3::X))), 0.0));
    assert_eq!(share(&mut rough, 1.0, &uneven(pushed.clone())), 0.0, "rough ground");
    let mut stands = goes(1.0, 1.0, true);
    stands.tick(&pushed, &Command { goal: Goal::Stay, ..Command::default() }, DT);
    assert_eq!(weight_of(&stands, CATCHES), 0.0, "without a target");
    let crouch = GraphPosition { from: n(1), to: n(common::policy("crouch")), t: 0.5 };
    let mut low = goes(1.0, 1.0, true);
    assert!(low.place_at(crouch));
    let target = Some(Vec2::X * 10.0);
    low.tick(&pushed, &Command { goal: Goal::Stay, target, ..Command::default() }, DT);
    assert_eq!(weight_of(&low, CATCHES), 0.0, "on the way to a crouch");
}

#[test]
fn a_walk_that_has_slowed_down_from_a_gait_without_a_variant_has_one() {
    let manifest = common::gaits(|gait| gait.catching = (gait.name != "jog").then(|| CATCHES.into()));
    let pack = Arc::new(CharacterPack::from_parts(manifest, common::tensors(0.0)).unwrap());
    let config = ControllerConfig { start: n(2), give_way: None, ..ControllerConfig::default() };
    let mut controller = Controller::with_config(pack, config);
    (0..60).for_each(|_| assert_eq!(share(&mut controller, 1.0, &moving(Vec3::X)), 0.0));
    assert_eq!(share(&mut controller, 1.0, &moving(Vec3::new(1.0, 0.7, 0.0))), 1.0);
}

#[test]
fn a_blend_by_hand_comes_first_and_an_unknown_name_is_refused() {
    let pushed = moving(Vec3::new(1.0, 1.2, 0.0));
    let mut controller = goes(1.0, 1.0, true);
    assert_eq!(share(&mut controller, 1.0, &pushed), 1.0);
    let by_hand = Command { blend: Some(Blend::single(PolicyId::new(2))), ..Command::default() };
    controller.tick(&pushed, &by_hand, DT);
    assert_eq!(acted(&controller), [(2, 1.0)]);
    let mut manifest = common::manifest();
    manifest.policies[1].catching = Some("trot".into());
    let error = CharacterPack::from_parts(manifest, common::tensors(0.0)).unwrap_err().to_string();
    assert!(error.contains("trot") && error.contains("walk"), "{error}");
}

#[test]
fn a_saved_state_goes_on_with_its_catch() {
    let pushed = moving(Vec3::new(1.0, 1.2, 0.0));
    let mut controller = goes(1.0, 1.0, true);
    share(&mut controller, 1.0, &pushed);
    let mut other = goes(2.0, 2.0, true);
    hand_over(&controller, &mut other);
    for state in [&pushed, &moving(Vec3::X), &moving(Vec3::X)] {
        let shares = [&mut controller, &mut other].map(|c| share(c, 1.0, state));
        assert!(shares[0] == shares[1] && shares[0] > 0.0);
        assert_eq!(controller.report(), other.report());
    }
}

#[test]
fn a_character_that_goes_on_out_of_a_skill_catches_itself_until_it_has_settled() {
    let after_a_roll = |capture_steps: bool, target: Option<Vec2>, rise: f32| {
        let config = ControllerConfig { capture_steps, start: n(1), ..ControllerConfig::default() };
        let mut controller = Controller::with_config(pack(), config);
        let mut state = moving(Vec3::X);
        state.ground_rises[Skeleton::humanoid().feet()[0].index()] = rise;
        let command = Command { goal: Goal::Node(n(1)), target, ..Command::default() };
        let roll = controller.pack().skill_named("roll");
        controller.tick(&state, &Command { skill: roll, ..command }, DT);
        assert_eq!(controller.report().skill_started, roll);
        while controller.report().skill_ended.is_none() {
            controller.tick(&state, &command, DT);
        }
        let shares = (0..30).map(|_| {
            controller.tick(&state, &command, DT);
            weight_of(&controller, CATCHES)
        });
        shares.collect::<Vec<_>>()
    };
    let ahead = Some(Vec2::X * 10.0);
    let shares = after_a_roll(true, ahead, 0.0);
    let caught = shares.iter().take_while(|share| **share == 1.0).count();
    assert!((13..=16).contains(&caught), "{shares:?}");
    assert_eq!(shares.last(), Some(&0.0));
    for left_alone in [after_a_roll(false, ahead, 0.0), after_a_roll(true, None, 0.0)] {
        assert!(left_alone.iter().all(|share| *share == 0.0), "{left_alone:?}");
    }
    assert_eq!(after_a_roll(true, ahead, 0.2)[14], 0.0, "rough ground");
}
