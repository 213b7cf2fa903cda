//! Shared helpers of the workspace's integration tests. The README's Rust code is a test of this crate.

pub mod golden;
pub mod made_up;

use std::sync::Arc;

use policy_core::CharacterPack;

/// The README, so that its code is compiled.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;

/// The character of the golden recordings: the humanoid as it was then, whose legs pass through each other.
pub const HUMANOID_MJCF: &str = include_str!("golden/humanoid.xml");

/// A character that is no humanoid: a trunk, a head and four legs.
pub const QUADRUPED_MJCF: &str = include_str!("assets/quadruped.xml");

/// Control ticks per second in the tests.
pub const CONTROL_HZ: f64 = 30.0;

/// Seconds of a control tick in the tests.
pub const DT_SECS: f32 = 1.0 / 30.0;

/// The policies that the golden walk was recorded with, idle and walk: never those of the day.
///
/// # Panics
/// When the pack is broken; it is part of the sources.
#[must_use]
pub fn reference_pack() -> Arc<CharacterPack> {
    let bytes = include_bytes!("golden/reference.pack.safetensors");
    Arc::new(CharacterPack::from_bytes(bytes).expect("the reference pack is sound"))
}
