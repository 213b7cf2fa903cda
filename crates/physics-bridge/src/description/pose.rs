//! Poses: of the bodies, for drawing, and generalised, for resetting a character.

use glam::{Quat, Vec3};
use policy_core::Skeleton;

/// Numbers of the root in `qpos`: position (3) and rotation (4, wxyz).
pub(crate) const ROOT_QPOS: usize = 7;

/// Numbers of the root in `qvel`: linear velocity (3) and angular velocity (3).
pub(crate) const ROOT_QVEL: usize = 6;

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

/// A generalised position and velocity in MuJoCo's terms, hinges in the order of the skeleton.
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    /// Position (3, metres) and rotation (4, wxyz quaternion) of the root, then the hinges, radians.
    pub qpos: Vec<f64>,
    /// Linear velocity of the root in world axes (3, metres per second), its angular velocity in its own axes
    /// (3, radians per second), then the hinges, radians per second.
    pub qvel: Vec<f64>,
}

/// Why a character can't take a pose.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PoseError {
    /// There are more or fewer numbers than the character has.
    #[error("expected {expected} numbers in {field}, found {found}")]
    Length {
        /// `qpos` or `qvel`.
        field: &'static str,
        /// Numbers of this character.
        expected: usize,
        /// Numbers found.
        found: usize,
    },
    /// A number is not finite.
    #[error("expected a finite number in {field}[{index}], found {found}")]
    NotFinite {
        /// `qpos` or `qvel`.
        field: &'static str,
        /// Index in it.
        index: usize,
        /// The number.
        found: f64,
    },
    /// The quaternion of the root is far from unit length.
    #[error("expected a unit quaternion in qpos[3..7], found length {length}")]
    Quaternion {
        /// Its length.
        length: f64,
    },
}

impl Pose {
    /// The root at the origin, everything zero, at rest. Allocates.
    #[must_use]
    pub fn new(skeleton: &Skeleton) -> Self {
        let joints = skeleton.joint_count();
        let mut qpos = vec![0.0; ROOT_QPOS + joints];
        qpos[3] = 1.0;
        Self { qpos, qvel: vec![0.0; ROOT_QVEL + joints] }
    }

    /// Refuses what does not fit a character of so many joints, and what MuJoCo would reset silently.
    pub(crate) fn check(qpos: &[f64], qvel: &[f64], joints: usize) -> Result<(), PoseError> {
        for (field, numbers, root) in [("qpos", qpos, ROOT_QPOS), ("qvel", qvel, ROOT_QVEL)] {
            let (expected, found) = (root + joints, numbers.len());
            if found != expected {
                return Err(PoseError::Length { field, expected, found });
            }
            if let Some(index) = numbers.iter().position(|v| !v.is_finite()) {
                return Err(PoseError::NotFinite { field, index, found: numbers[index] });
            }
        }
        let length = qpos[3..7].iter().map(|v| v * v).sum::<f64>().sqrt();
        if (length - 1.0).abs() > 1e-3 {
            return Err(PoseError::Quaternion { length });
        }
        Ok(())
    }
}

/// MuJoCo's wxyz quaternion in single precision.
pub(crate) fn rotation([w, x, y, z]: [f64; 4]) -> Quat {
    Quat::from_xyzw(x as f32, y as f32, z as f32, w as f32)
}
