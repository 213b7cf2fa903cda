//! Position and velocity of a whole character: what it is reset to.

use alloc::vec;
use alloc::vec::Vec;

use crate::skeleton::Skeleton;

/// Numbers of the root in [`Pose::qpos`]: position (3) and rotation (4, wxyz).
pub const ROOT_QPOS: usize = 7;

/// Numbers of the root in [`Pose::qvel`]: linear velocity (3) and angular velocity (3).
pub const ROOT_QVEL: usize = 6;

/// Position and velocity of a whole character, laid out as MuJoCo does, hinges in the order of the skeleton.
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

    /// Checks a pose for a character of so many joints.
    ///
    /// # Errors
    /// When a length does not fit, a number is not finite, or the quaternion's length is off by more than 0.001.
    pub fn check(qpos: &[f64], qvel: &[f64], joints: usize) -> Result<(), PoseError> {
        for (field, numbers, root) in [("qpos", qpos, ROOT_QPOS), ("qvel", qvel, ROOT_QVEL)] {
            let (expected, found) = (root + joints, numbers.len());
            if found != expected {
                return Err(PoseError::Length { field, expected, found });
            }
            if let Some(index) = numbers.iter().position(|v| !v.is_finite()) {
                return Err(PoseError::NotFinite { field, index, found: numbers[index] });
            }
        }
        let length = libm::sqrt(qpos[3..7].iter().map(|v| v * v).sum::<f64>());
        if libm::fabs(length - 1.0) > 1e-3 {
            return Err(PoseError::Quaternion { length });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_new_pose_is_sound_and_broken_ones_are_refused() {
        let skeleton = Skeleton::humanoid();
        let joints = skeleton.joint_count();
        let Pose { qpos, qvel } = Pose::new(&skeleton);
        assert_eq!(Pose::check(&qpos, &qvel, joints), Ok(()));
        let short = Pose::check(&qpos[1..], &qvel, joints);
        assert_eq!(short, Err(PoseError::Length { field: "qpos", expected: 35, found: 34 }));
        let mut broken = qvel.clone();
        broken[8] = f64::INFINITY;
        let found = f64::INFINITY;
        assert_eq!(
            Pose::check(&qpos, &broken, joints),
            Err(PoseError::NotFinite { field: "qvel", index: 8, found })
        );
        let mut long = qpos;
        long[4] = 0.1;
        assert!(matches!(Pose::check(&long, &qvel, joints), Err(PoseError::Quaternion { .. })));
    }
}
