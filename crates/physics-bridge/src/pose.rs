//! Poses: of the bodies, for drawing, and generalised, for setting a character up.

use glam::{Quat, Vec3};
use policy_core::BODY_COUNT;

use crate::{QPOS_LEN, QVEL_LEN};

/// Where the body frames are, world space, in the order of [`policy_core::Body`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyPoses {
    /// Origins of the body frames, metres.
    pub positions: [Vec3; BODY_COUNT],
    /// `world_from_body`, unit quaternions.
    pub rotations: [Quat; BODY_COUNT],
}

impl Default for BodyPoses {
    fn default() -> Self {
        Self { positions: [Vec3::ZERO; BODY_COUNT], rotations: [Quat::IDENTITY; BODY_COUNT] }
    }
}

/// A generalised position and velocity in MuJoCo's terms, hinges in the order of policy-core.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Metres, a wxyz quaternion, radians; see [`QPOS_LEN`].
    pub qpos: [f64; QPOS_LEN],
    /// Metres and radians per second; see [`QVEL_LEN`].
    pub qvel: [f64; QVEL_LEN],
}

/// Why a character can't take a pose.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PoseError {
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
    /// The pelvis' quaternion is far from unit length.
    #[error("expected a unit quaternion in qpos[3..7], found length {length}")]
    Quaternion {
        /// Its length.
        length: f64,
    },
}

impl Pose {
    /// Refuses what MuJoCo would answer with a silent reset.
    pub(crate) fn check(qpos: &[f64; QPOS_LEN], qvel: &[f64; QVEL_LEN]) -> Result<(), PoseError> {
        for (field, numbers) in [("qpos", &qpos[..]), ("qvel", &qvel[..])] {
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
