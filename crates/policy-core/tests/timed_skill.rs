//! Timed skills: their policy sees a clock in place of the target.

mod common;

use std::sync::Arc;

use common::standing;
use policy_core::glam::Vec2;
use policy_core::training::clock_input;
use policy_core::{CharacterPack, Command, Controller};

const DT: f32 = 1.0 / 30.0;

#[test]
fn a_timed_skill_sees_its_clock_and_afterwards_the_policy_sees_its_target_again() {
    let mut manifest = common::manifest();
    (manifest.skills[0].clock_seconds, manifest.skills[0].discriminator) = (Some(0.6), None);
    manifest.skills[0].entry.clear();
    manifest.skills[0].end.limit_seconds = 1.0;
    let pack = Arc::new(CharacterPack::from_parts(manifest.clone(), common::tensors(-4.0)).unwrap());
    let read = CharacterPack::from_bytes(&pack.to_bytes()).unwrap();
    assert_eq!(read.skills()[0].clock_seconds, Some(0.6));
    let mut controller = Controller::new(pack);
    let aside = Command { target: Some(Vec2::new(0.0, 3.0)), ..Command::default() };
    let seen = |controller: &Controller| {
        let input = controller.policy_input();
        [input[input.len() - 2], input[input.len() - 1]]
    };
    let request = Command { skill: Some(policy_core::SkillId::new(0)), ..aside };
    controller.tick(&standing(), &request, DT);
    for tick in 0..29 {
        let clock = clock_input(tick as f32 * DT, 0.6);
        let is = seen(&controller);
        assert!(controller.report().skill.is_some() && is[0].hypot(is[1]) > 2.49, "{tick}: {is:?}");
        assert!((is[0] - clock[0]).hypot(is[1] - clock[1]) < 1e-4, "{tick}: {is:?} instead of {clock:?}");
        controller.tick(&standing(), &aside, DT);
    }
    for _ in 0..30 {
        controller.tick(&standing(), &aside, DT);
    }
    assert!(controller.report().skill.is_none());
    assert_eq!(seen(&controller), controller.report().target);
    for seconds in [0.0, -1.0, 601.0, f32::NAN] {
        manifest.skills[0].clock_seconds = Some(seconds);
        let error =
            CharacterPack::from_parts(manifest.clone(), common::tensors(-4.0)).unwrap_err().to_string();
        assert!(error.contains("clock_seconds") && error.contains("roll"), "{error}");
    }
}
