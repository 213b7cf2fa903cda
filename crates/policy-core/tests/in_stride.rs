//! A skill in whose place others act in the stride of a gait: they start in step, and reports name the skill that was asked for.

mod common;

use std::sync::Arc;

use common::{hand_over, saved_and_read, standing};
use policy_core::format::{Manifest, SkillEntry};
use policy_core::glam::Vec3;
use policy_core::{
    Blend, CharacterPack, CharacterState, Command, Controller, ControllerConfig, PolicyId, SkillEnd, SkillId,
};

const DT: f32 = 1.0 / 30.0;
const LEAP_SECONDS: f32 = 0.5;
const HOP_SECONDS: f32 = 0.3;

/// A roll out of a stand, by a clock, with a leap in its place out of a jog, and a hop out of a walk.
fn manifest() -> Manifest {
    let mut manifest = common::manifest();
    let roll = &mut manifest.skills[0];
    (roll.entry, roll.maximum_speed_mps) = (vec!["idle".into()], Some(0.5));
    roll.in_stride = vec!["leap".into(), "hop".into()];
    let mut leap = SkillEntry {
        name: "leap".into(),
        policy: "run".into(),
        entry: vec!["jog".into()],
        minimum_speed_mps: 1.5,
        maximum_speed_mps: None,
        on_footfall: true,
        in_stride: Vec::new(),
        clock_seconds: Some(LEAP_SECONDS),
        returns_to: "jog".into(),
        discriminator: None,
        ..roll.clone()
    };
    leap.end.limit_seconds = LEAP_SECONDS;
    let mut hop = SkillEntry {
        name: "hop".into(),
        policy: "crouch".into(),
        entry: vec!["walk".into()],
        minimum_speed_mps: 0.6,
        returns_to: "walk".into(),
        ..leap.clone()
    };
    hop.end.limit_seconds = HOP_SECONDS;
    manifest.skills.extend([leap, hop]);
    manifest
}

fn pack() -> Arc<CharacterPack> {
    Arc::new(CharacterPack::from_parts(manifest(), common::tensors(-4.0)).unwrap())
}

fn jogging(pack: &Arc<CharacterPack>) -> Controller {
    going(pack, "jog")
}

fn going(pack: &Arc<CharacterPack>, gait: &str) -> Controller {
    let start = pack.graph().node_named(gait).unwrap();
    Controller::with_config(pack.clone(), ControllerConfig { start, ..ControllerConfig::default() })
}

/// A body that moves ahead as a whole, but for a foot that stands so far ahead of the root.
fn moving(speed: f32, foot_ahead: f32) -> CharacterState {
    let mut state = standing();
    let skeleton = policy_core::Skeleton::humanoid();
    for body in &mut state.bodies {
        body.linear_velocity = speed * Vec3::X;
    }
    let ahead = state.bodies[0].position.x + foot_ahead;
    let foot = state.body_mut(skeleton.feet()[0]);
    (foot.linear_velocity, foot.position.x) = (Vec3::ZERO, ahead);
    state
}

fn policy(pack: &CharacterPack, name: &str) -> Blend {
    Blend::single(PolicyId::from(pack.graph().node_named(name).unwrap()))
}

fn ask(controller: &mut Controller, state: &CharacterState, skill: Option<SkillId>) {
    controller.tick(state, &Command { skill, ..Command::default() }, DT);
}

#[test]
fn in_the_stride_of_a_run_another_skill_acts_from_a_footfall_on() {
    let pack = pack();
    let [roll, leap] = ["roll", "leap"].map(|name| pack.skill_named(name).unwrap());
    let mut controller = jogging(&pack);
    ask(&mut controller, &moving(2.0, -0.1), Some(roll));
    for _ in 0..5 {
        ask(&mut controller, &moving(2.0, -0.1), None);
        let report = controller.report();
        assert_eq!((report.skill, report.pending_skill), (None, Some(roll)), "the foot stands behind");
        assert_eq!(report.goal.as_node(), pack.graph().node_named("jog"), "it jogs on");
    }
    ask(&mut controller, &moving(2.0, 0.1), None);
    assert_eq!(controller.report().skill_started, Some(roll));
    let mut other = jogging(&pack);
    hand_over(&controller, &mut other);
    let mut ticks = 1;
    while controller.report().skill_ended.is_none() {
        for one in [&mut controller, &mut other] {
            let progress = one.report().skill.unwrap();
            assert_eq!((progress.skill, progress.acts), (roll, leap));
            assert_eq!(one.report().blend, policy(&pack, "run"), "the leap's policy acts");
            ask(one, &moving(2.0, 0.1), None);
        }
        assert_eq!(controller.joint_targets(), other.joint_targets());
        ticks += 1;
    }
    assert_eq!(ticks, (LEAP_SECONDS / DT).round() as usize + 1, "its own clock ends it");
    assert_eq!(controller.report().skill_ended, Some((roll, SkillEnd::TimeLimit)));
    assert_eq!(controller.report().position.as_node(), pack.graph().node_named("jog"));
    ask(&mut controller, &moving(2.0, 0.1), Some(roll));
    assert_eq!(controller.report().skill, None, "it settles first");
}

#[test]
fn in_the_stride_of_a_walk_the_one_that_fits_acts() {
    let pack = pack();
    let [roll, hop] = ["roll", "hop"].map(|name| pack.skill_named(name).unwrap());
    let mut controller = going(&pack, "walk");
    let mut turns = moving(1.6, 0.1);
    turns.bodies[0].angular_velocity = 2.0 * Vec3::Z;
    ask(&mut controller, &turns, Some(roll));
    assert_eq!(
        (controller.report().skill, controller.report().pending_skill),
        (None, Some(roll)),
        "it turns"
    );
    // As fast as a leap needs; what decides is the gait.
    ask(&mut controller, &moving(1.6, 0.1), None);
    let progress = controller.report().skill.unwrap();
    assert_eq!((progress.skill, progress.acts), (roll, hop));
    let mut ticks = 1;
    while controller.report().skill_ended.is_none() {
        ask(&mut controller, &moving(1.0, 0.1), None);
        ticks += 1;
    }
    assert_eq!(ticks, (HOP_SECONDS / DT).round() as usize + 1, "its own clock ends it");
    assert_eq!(controller.report().position.as_node(), pack.graph().node_named("walk"));
}

#[test]
fn a_slow_character_comes_to_a_stand_for_the_skill_itself() {
    let pack = pack();
    let roll = pack.skill_named("roll").unwrap();
    let mut controller = jogging(&pack);
    ask(&mut controller, &moving(1.2, 0.1), Some(roll));
    assert_eq!(controller.report().skill, None);
    assert_eq!(controller.report().goal.as_node(), pack.graph().node_named("idle"), "it brakes");
    for _ in 0..60 {
        ask(&mut controller, &standing(), None);
        if let Some(progress) = controller.report().skill {
            assert_eq!((progress.skill, progress.acts), (roll, roll));
            return;
        }
    }
    panic!("it never started");
}

#[test]
fn a_pack_says_what_it_lacks() {
    let read = CharacterPack::from_bytes(&pack().to_bytes()).unwrap();
    assert_eq!(read.manifest().skills, manifest().skills);
    let error = |change: fn(&mut Manifest)| {
        let mut wrong = manifest();
        change(&mut wrong);
        CharacterPack::from_parts(wrong, common::tensors(-4.0)).unwrap_err().to_string()
    };
    let nowhere = error(|m| m.skills[0].in_stride = vec!["skip".into()]);
    assert!(nowhere.contains("in_stride of skill \"roll\"") && nowhere.contains("skip"), "{nowhere}");
    for change in [
        (|m| m.skills[2].minimum_speed_mps = 0.0) as fn(&mut Manifest),
        |m| m.skills[2].in_stride = vec!["get_up".into()],
        |m| m.skills[0].in_stride = vec!["get_up".into()],
    ] {
        let said = error(change);
        assert!(said.contains("in_stride of skill") && said.contains("minimum_speed_mps"), "{said}");
    }
}

#[test]
fn a_state_whose_skill_is_not_in_this_pack_is_refused_and_a_new_pack_drops_it() {
    let pack = pack();
    let mut controller = jogging(&pack);
    ask(&mut controller, &moving(2.0, 0.1), pack.skill_named("roll"));
    let [saved, _] = saved_and_read(&controller);
    let mut without = manifest();
    without.skills[0].in_stride.clear();
    let without = Arc::new(CharacterPack::from_parts(without, common::tensors(-4.0)).unwrap());
    let said = jogging(&without).restore(&saved).unwrap_err().to_string();
    assert!(said.contains("skill that acts"), "{said}");
    controller.set_pack(without).unwrap();
    assert_eq!(controller.report().skill, None);
}
