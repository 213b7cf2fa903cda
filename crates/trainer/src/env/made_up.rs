//! Clips that the tests of this folder make up.

use clips::Clip;
use glam::{Quat, Vec3};
use policy_core::Skeleton;

/// Index of a body of the humanoid.
pub(super) fn body(name: &str) -> usize {
    Skeleton::humanoid().body_named(name).unwrap().index()
}

/// The humanoid at rest, 0.9 m up, for so many frames at 30 Hz.
pub(super) fn still(frames: usize) -> Clip {
    let bodies = Skeleton::humanoid().bodies().iter().map(|body| body.name.clone()).collect();
    Clip {
        name: "still".into(),
        looping: false,
        times: (0..frames).map(|i| i as f32 / 30.0).collect(),
        root_positions: vec![Vec3::new(0.0, 0.0, 0.9); frames],
        local_rotations: vec![vec![Quat::IDENTITY; 15]; frames],
        bodies,
    }
}
