//! Position and velocity of a whole character, laid out as MuJoCo does.

use policy_core::Skeleton;

/// Numbers of the root in `qpos`: position and quaternion.
pub(crate) const ROOT_QPOS: usize = 7;

/// Numbers of the root in `qvel`: linear and angular velocity.
pub(crate) const ROOT_QVEL: usize = 6;

/// Position and velocity of a character in MuJoCo's terms, hinges in the order of the skeleton.
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    /// Position (3, metres) and rotation (4, wxyz quaternion) of the root's frame, then the hinges, radians.
    pub qpos: Vec<f64>,
    /// Linear velocity of the root's frame in world axes (3, metres per second), its angular velocity in its own
    /// axes (3, radians per second), then the hinges, radians per second.
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

    /// Refuses what does not fit a character of so many hinges.
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
