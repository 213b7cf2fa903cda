//! Settling: after a skill a character stays in the gait that the skill returns to for a moment, and turns little.

mod common;

use std::sync::Arc;

use common::{hand_over, standing};
use policy_core::glam::{Vec2, Vec3};
use policy_core::{
    CharacterPack, Command, Controller, ControllerConfig, Goal, GraphPosition, Refusal, Skeleton,
};

const DT: f32 = 1.0 / 30.0;

#[test]
fn after_a_skill_the_character_settles_before_it_goes_on() {
    let pack = Arc::new(common::pack(-4.0));
    let (walk, roll) = (pack.graph().node_named("walk").unwrap(), pack.skill_named("roll"));
    let goal = Goal::Node(pack.graph().node_named("run").unwrap());
    let settled = |settle_secs: f32, saved: bool| {
        let config =
            ControllerConfig { settle_secs, start: walk, steering: None, ..ControllerConfig::default() };
        let mut controller = Controller::with_config(pack.clone(), config);
        let aside = Command { target: Some(Vec2::new(0.0, 4.0)), goal, ..Command::default() };
        controller.tick(&standing(), &Command { skill: roll, ..aside }, DT);
        while controller.report().skill_ended.is_none() {
            controller.tick(&standing(), &aside, DT);
        }
        let (mut ticks, mut seen) = (0, Vec::new());
        while controller.report().position == GraphPosition::node(walk) {
            let [x, y] = controller.report().target;
            seen.push(y.atan2(x));
            if saved {
                let before =
                    std::mem::replace(&mut controller, Controller::with_config(pack.clone(), config));
                hand_over(&before, &mut controller);
            }
            controller.tick(&standing(), &aside, DT);
            ticks += 1;
        }
        let [x, y] = controller.report().target;
        (ticks, seen, y.atan2(x))
    };
    let (ticks, seen, after) = settled(0.5, false);
    assert!((14..=16).contains(&ticks), "{ticks} ticks");
    assert!(seen.iter().all(|angle| (angle - 0.5).abs() < 1e-3), "{seen:?}");
    assert!(
        (after - std::f32::consts::FRAC_PI_2).abs() < 1e-3,
        "then it turns as far as it is asked to: {after}"
    );
    assert_eq!(settled(0.5, true), settled(0.5, false), "it is part of the state");
    assert!(settled(0.0, false).0 <= 1);
}

/// A gait that stands brakes by its agile variant without a target alone.
#[test]
fn a_character_that_is_to_stand_for_a_skill_or_after_one_has_no_target() {
    let mut manifest = common::manifest();
    manifest.policies[0].speed_mps = Some(0.0);
    let jump = &mut manifest.skills[0];
    (jump.entry, jump.returns_to, jump.discriminator) = (vec!["idle".into()], "idle".into(), None);
    (jump.maximum_speed_mps, jump.end.limit_seconds) = (Some(0.5), 0.5);
    let pack = Arc::new(CharacterPack::from_parts(manifest, common::tensors(-4.0)).unwrap());
    let (walk, jump) = (pack.graph().node_named("walk").unwrap(), pack.skill_named("roll"));
    let config = ControllerConfig { start: walk, steering: None, ..ControllerConfig::default() };
    let mut controller = Controller::with_config(pack, config);
    let ahead = Command { target: Some(Vec2::new(4.0, 0.0)), goal: Goal::Node(walk), ..Command::default() };
    let mut moving = standing();
    moving.bodies[0].linear_velocity.x = 1.0;
    controller.tick(&moving, &ahead, DT);
    assert_ne!(controller.report().target, [0.0; 2], "a walk goes to its target");
    controller.tick(&moving, &Command { skill: jump, ..ahead }, DT);
    for _ in 0..20 {
        assert_eq!((controller.report().skill, controller.report().target), (None, [0.0; 2]), "it brakes");
        controller.tick(&moving, &ahead, DT);
    }
    // It stands, jumps, and is asked for another jump meanwhile.
    controller.tick(&standing(), &Command { skill: jump, ..ahead }, DT);
    assert_eq!(controller.report().skill_started, jump);
    controller.tick(&standing(), &Command { skill: jump, ..ahead }, DT);
    while controller.report().skill_ended.is_none() {
        controller.tick(&standing(), &ahead, DT);
    }
    let mut settled = 0;
    while controller.report().skill_started.is_none() {
        assert_eq!(controller.report().target, [0.0; 2], "it settles");
        controller.tick(&standing(), &ahead, DT);
        settled += 1;
    }
    assert!((14..=16).contains(&settled), "the second jump waits until it has settled: {settled} ticks");
    while controller.report().skill_ended.is_none() {
        controller.tick(&standing(), &ahead, DT);
    }
    for _ in 0..17 {
        controller.tick(&standing(), &ahead, DT);
    }
    assert_ne!(controller.report().target, [0.0; 2], "then it goes on");
}

#[test]
fn getting_up_that_was_asked_for_in_a_roll_is_refused_once_the_roll_has_set_the_character_on_its_feet() {
    let pack = Arc::new(common::pack(-4.0));
    let [roll, get_up] = ["roll", "get_up"].map(|name| pack.skill_named(name).unwrap());
    let start = pack.graph().node_named("walk").unwrap();
    let config = ControllerConfig { start, ..ControllerConfig::default() };
    let mut controller = Controller::with_config(pack, config);
    controller.tick(&standing(), &Command { skill: Some(roll), ..Command::default() }, DT);
    let mut low = standing();
    low.bodies[0].position.z = 0.2;
    controller.tick(&low, &Command { skill: Some(get_up), ..Command::default() }, DT);
    assert_eq!(controller.report().pending_skill, Some(get_up));
    while controller.report().skill.is_some() {
        controller.tick(&standing(), &Command::default(), DT);
    }
    assert_eq!(controller.report().skill_ended.map(|(skill, _)| skill), Some(roll));
    assert_eq!(controller.report().skill_refused, Some((get_up, Refusal::Upright)));
    assert_eq!(controller.report().pending_skill, None);
}

#[test]
fn a_skill_that_needs_a_slow_character_waits_while_it_tips_over() {
    let mut manifest = common::manifest();
    manifest.skills[0].maximum_speed_mps = Some(0.7);
    let pack = Arc::new(CharacterPack::from_parts(manifest, common::tensors(-4.0)).unwrap());
    let roll = pack.skill_named("roll");
    // The skill starts out of a walk, and the character stands.
    let skeleton = Skeleton::humanoid();
    for caught in [true, false] {
        let mut controller = Controller::new(pack.clone());
        let mut tick = |leans: f32, skill| {
            let mut state = standing();
            for foot in skeleton.feet() {
                state.body_mut(*foot).position = Vec3::new(0.0, -leans, 0.07);
            }
            controller.tick(&state, &Command { skill, ..Command::default() }, DT);
            controller.report().skill_started
        };
        assert_eq!(tick(0.2, roll), None);
        for _ in 0..60 {
            assert_eq!(tick(0.2, None), None, "it tips over");
        }
        if caught {
            assert_eq!(tick(0.02, None), roll, "it has caught itself");
        } else {
            assert!(
                (0..30).any(|_| tick(0.2, None) == roll),
                "one that has not fallen by then stands like that"
            );
        }
    }
}
