//! Poses of the bodies, for drawing.

use glam::{Quat, Vec3};
use policy_core::Skeleton;

/// Where the body frames are, world space, in the order of the skeleton.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyPoses {
    /// Origins of the body frames, metres.
    pub positions: Vec<Vec3>,
    /// `world_from_body`, unit quaternions.
    pub rotations: Vec<Quat>,
}

impl BodyPoses {
    /// All bodies at the origin. Allocates.
    #[must_use]
    pub fn new(skeleton: &Skeleton) -> Self {
        let count = skeleton.body_count();
        Self { positions: vec![Vec3::ZERO; count], rotations: vec![Quat::IDENTITY; count] }
    }

    /// Copies the numbers of `other`. Allocates only when the sizes differ.
    pub fn copy_from(&mut self, other: &Self) {
        self.positions.clone_from(&other.positions);
        self.rotations.clone_from(&other.rotations);
    }
}

/// MuJoCo's wxyz quaternion in single precision.
pub(crate) fn rotation([w, x, y, z]: [f64; 4]) -> Quat {
    Quat::from_xyzw(x as f32, y as f32, z as f32, w as f32)
}
