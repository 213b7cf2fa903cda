//! What the tests of this crate share.
#![allow(dead_code, missing_docs, reason = "each test uses its part")]

use physics_bridge::{Character, Model};
use policy_core::JointTargets;

pub const HUMANOID: &str = include_str!("../../../../assets/humanoid.xml");

pub fn humanoid() -> Model {
    Model::from_mjcf(HUMANOID).unwrap()
}

/// Targets that keep the character moving, different in every tick.
pub fn wriggle(tick: u64) -> JointTargets {
    let mut targets = JointTargets::default();
    for (joint, target) in targets.0.iter_mut().enumerate() {
        *target = 0.4 * (0.3 * tick as f32 + joint as f32).sin();
    }
    targets
}

/// Steps `ticks` ticks of [`wriggle`].
pub fn run(character: &mut Character, ticks: u64) {
    for _ in 0..ticks {
        character.actuate(&wriggle(character.tick()));
        character.step().unwrap();
    }
}

pub fn hash(character: &Character) -> u64 {
    character.save().hash()
}
