//! Settling: after a skill a character stays in the gait that the skill returns to for a moment, and turns little.

mod common;

use std::sync::Arc;

use common::{hand_over, standing};
use policy_core::glam::Vec2;
use policy_core::{Command, Controller, ControllerConfig, Goal, GraphPosition};

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
