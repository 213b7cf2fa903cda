//! Skills that wait for their moment, are refused or interrupted, and what another pack keeps of them.

mod common;

use std::sync::Arc;

use common::{n, standing};
use policy_core::{
    CharacterPack, Command, Controller, ControllerConfig, Goal, PathId, Refusal, SkillEnd, SwapError,
};

const DT: f32 = 1.0 / 30.0;

fn bits(controller: &Controller) -> Vec<u32> {
    controller.joint_targets().iter().map(|t| t.to_bits()).collect()
}

#[test]
fn the_recovery_skill_is_refused_while_upright_and_a_pending_skill_can_be_cancelled() {
    let pack = Arc::new(common::pack(0.0));
    let mut controller = Controller::new(pack.clone());
    let get_up = pack.skill_named("get_up").unwrap();
    controller.tick(&standing(), &Command { skill: Some(get_up), ..Command::default() }, DT);
    assert_eq!(controller.report().skill_refused, Some((get_up, Refusal::Upright)));
    assert_eq!((controller.report().skill, controller.report().pending_skill), (None, None));
    let mut lying = standing();
    lying.bodies[0].position.z = 0.2;
    controller.tick(&lying, &Command { skill: Some(get_up), ..Command::default() }, DT);
    assert_eq!(controller.report().skill_started, Some(get_up));
    let mut idle = Controller::new(pack.clone());
    let roll = pack.skill_named("roll");
    idle.tick(&standing(), &Command { skill: roll, ..Command::default() }, DT);
    assert_eq!((idle.report().pending_skill, idle.cancel_pending_skill()), (roll, roll));
    idle.tick(&standing(), &Command::default(), DT);
    assert_eq!((idle.report().pending_skill, idle.report().skill), (None, None));
    let unknown = policy_core::SkillId::new(40);
    idle.tick(&standing(), &Command { skill: Some(unknown), ..Command::default() }, DT);
    assert_eq!(idle.report().skill_refused, Some((unknown, Refusal::Unknown)));
}

#[test]
fn a_reset_in_the_middle_of_a_skill_is_reported_by_the_next_tick() {
    let pack = Arc::new(common::pack(-4.0));
    let roll = pack.skill_named("roll").unwrap();
    let start = pack.graph().node_named("walk").unwrap();
    let config = ControllerConfig { start, ..ControllerConfig::default() };
    let mut controller = Controller::with_config(pack, config);
    controller.tick(&standing(), &Command { skill: Some(roll), ..Command::default() }, DT);
    controller.reset();
    controller.tick(&standing(), &Command::default(), DT);
    assert_eq!(controller.report().skill_ended, Some((roll, SkillEnd::Interrupted)));
    controller.tick(&standing(), &Command::default(), DT);
    assert_eq!(controller.report().skill_ended, None);
}

#[test]
fn another_pack_keeps_position_and_skill_by_their_names() {
    let pack = Arc::new(common::pack(-4.0));
    let mut controller = Controller::new(pack.clone());
    let goal = Goal::Path { path: PathId::new(0), coordinate: 2.5 };
    for _ in 0..90 {
        controller.tick(&standing(), &Command { goal, ..Command::default() }, DT);
    }
    // The same nodes in another order.
    let (mut manifest, mut tensors) = (common::manifest(), common::tensors(-4.0));
    manifest.policies.reverse();
    tensors.policies.reverse();
    manifest.skills.reverse();
    let reordered = Arc::new(CharacterPack::from_parts(manifest, tensors).unwrap());
    let before = bits(&controller);
    controller.set_pack(reordered.clone()).unwrap();
    let speed = reordered.graph().path(PathId::new(0));
    assert_eq!(speed.coordinate(controller.report().position), Some(2.5));
    controller.tick(&standing(), &Command::default(), DT);
    // The sum of two policies in the other order: the same up to rounding.
    let after = bits(&controller);
    let close =
        before.iter().zip(&after).all(|(a, b)| (f32::from_bits(*a) - f32::from_bits(*b)).abs() < 1e-4);
    assert!(close, "the same blend of the same policies");
    let mut other = common::manifest();
    other.skeleton.bodies[14].name = "tail".into();
    other.skeleton.joints.iter_mut().filter(|j| j.body == "left_foot").for_each(|j| j.body = "tail".into());
    other.skeleton.roles.feet[1] = "tail".into();
    let other = CharacterPack::from_parts(other, common::tensors(0.0)).unwrap();
    assert_eq!(controller.set_pack(Arc::new(other)), Err(SwapError::Skeleton));
    assert_eq!(controller.pack().manifest(), reordered.manifest());
}

#[test]
fn another_pack_keeps_an_interruption_and_the_times_of_skills() {
    let pack = Arc::new(common::pack(-4.0));
    let roll = pack.skill_named("roll").unwrap();
    let request = Command { skill: Some(roll), ..Command::default() };
    let config = ControllerConfig { start: n(1), ..ControllerConfig::default() };
    let mut reset = Controller::with_config(pack.clone(), config);
    reset.tick(&standing(), &request, DT);
    reset.reset();
    reset.set_pack(pack.clone()).unwrap();
    reset.tick(&standing(), &Command::default(), DT);
    assert_eq!(reset.report().skill_ended, Some((roll, SkillEnd::Interrupted)));

    // A skill that needs a speed waits for it, 4 s in all.
    let mut manifest = common::manifest();
    manifest.skills[0].minimum_speed_mps = 0.8;
    let slow = Arc::new(CharacterPack::from_parts(manifest, common::tensors(-4.0)).unwrap());
    let mut waits = Controller::with_config(slow.clone(), config);
    waits.tick(&standing(), &request, DT);
    for _ in 0..60 {
        waits.tick(&standing(), &Command::default(), DT);
    }
    waits.set_pack(slow).unwrap();
    let left = (0..200).position(|_| {
        waits.tick(&standing(), &Command::default(), DT);
        waits.report().skill_refused.is_some()
    });
    assert!(left.is_some_and(|ticks| (55..65).contains(&ticks)), "{left:?} ticks");

    let mut settles = Controller::with_config(pack.clone(), config);
    settles.tick(&standing(), &request, DT);
    while settles.report().skill_ended.is_none() {
        settles.tick(&standing(), &Command::default(), DT);
    }
    settles.set_pack(pack).unwrap();
    let goal = Goal::Path { path: PathId::new(0), coordinate: 3.0 };
    settles.tick(&standing(), &Command { goal, ..Command::default() }, DT);
    assert_eq!(settles.report().position.as_node(), Some(n(1)), "it stays in its gait for a moment");
}

#[test]
fn a_skill_that_needs_a_slow_character_waits_for_it() {
    let mut manifest = common::manifest();
    manifest.skills[0].maximum_speed_mps = Some(0.5);
    let pack = Arc::new(CharacterPack::from_parts(manifest.clone(), common::tensors(-4.0)).unwrap());
    let read = CharacterPack::from_bytes(&pack.to_bytes()).unwrap();
    assert_eq!(read.skills()[0].maximum_speed_mps, 0.5);
    let roll = pack.skill_named("roll").unwrap();
    let mut moving = standing();
    moving.bodies[0].linear_velocity = policy_core::glam::Vec3::new(0.0, 0.9, 0.0);
    let mut controller = Controller::new(pack);
    controller.tick(&moving, &Command { skill: Some(roll), ..Command::default() }, DT);
    for _ in 0..30 {
        controller.tick(&moving, &Command::default(), DT);
        assert_eq!((controller.report().skill, controller.report().pending_skill), (None, Some(roll)));
    }
    controller.tick(&standing(), &Command::default(), DT);
    assert_eq!(controller.report().skill_started, Some(roll));
    for (least, most) in [(0.0, 0.0), (0.8, 0.8), (0.0, 20.5), (0.0, f32::NAN)] {
        (manifest.skills[0].minimum_speed_mps, manifest.skills[0].maximum_speed_mps) = (least, Some(most));
        let error =
            CharacterPack::from_parts(manifest.clone(), common::tensors(-4.0)).unwrap_err().to_string();
        assert!(error.contains("maximum_speed_mps") && error.contains("roll"), "{error}");
    }
}

#[test]
fn a_skill_that_needs_speed_takes_a_run_up_and_gives_up_when_it_is_blocked() {
    let mut manifest = common::manifest();
    manifest.skills[0].minimum_speed_mps = 0.8;
    let pack = Arc::new(CharacterPack::from_parts(manifest, common::tensors(-4.0)).unwrap());
    let roll = pack.skill_named("roll").unwrap();
    let request = Command { skill: Some(roll), ..Command::default() };
    let mut moving = standing();
    moving.bodies[0].linear_velocity = policy_core::glam::Vec3::new(0.0, 0.9, 0.0);

    let mut controller = Controller::new(pack.clone());
    controller.tick(&standing(), &request, DT);
    for _ in 0..60 {
        controller.tick(&standing(), &Command::default(), DT);
        assert_eq!(controller.report().target, [2.5, 0.0], "straight ahead");
    }
    assert_eq!((controller.report().skill, controller.report().pending_skill), (None, Some(roll)));
    controller.tick(&moving, &Command::default(), DT);
    assert_eq!(controller.report().skill_started, Some(roll));

    let mut blocked = Controller::new(pack);
    blocked.tick(&standing(), &request, DT);
    let refused = (0..200).find_map(|_| {
        blocked.tick(&standing(), &Command::default(), DT);
        blocked.report().skill_refused
    });
    assert_eq!(refused, Some((roll, Refusal::TookTooLong)));
    blocked.tick(&standing(), &Command::default(), DT);
    assert_eq!((blocked.report().pending_skill, blocked.report().target), (None, [0.0; 2]));
}
