//! Postures: constant offsets of a policy's joint targets.
//!
//! An offset of an output bias changes a policy's pose and hardly what it does: a trunk that leans back by five degrees stands upright. It
//! is as good a direction for a [search](crate::search) as the way to another policy.

use std::collections::BTreeMap;

use policy_core::Skeleton;
use policy_core::training::ActionScaling;

use crate::env::{MirrorError, mirrored_joints};

/// Largest offset, radians.
const MOST_RADIANS: f64 = 1.0;

/// Offsets of all joint targets, alike on both sides.
#[derive(Clone, Debug, PartialEq)]
pub struct Posture {
    /// Of each joint, in units of its action.
    offsets: Vec<f64>,
}

/// Why a posture can't be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PostureError {
    /// A name is none of a joint.
    #[error("posture: expected one of {}, found {found:?}", known.join(", "))]
    Unknown {
        /// The name.
        found: String,
        /// Names of the joints.
        known: Vec<String>,
    },
    /// A joint of the middle that leans or turns to one side.
    #[error("posture: expected joints that can move alike on both sides, found {found}")]
    OneSided {
        /// The joint.
        found: String,
    },
    /// Both sides of a joint are named.
    #[error(
        "posture: expected one side of {first}, which moves the other side too, found {second} beside it"
    )]
    BothSides {
        /// A joint.
        first: String,
        /// The same on the other side.
        second: String,
    },
    /// An offset is no number, or too large.
    #[error("posture: expected radians from -{MOST_RADIANS} to {MOST_RADIANS} for {joint}, found {found}")]
    Offset {
        /// The joint.
        joint: String,
        /// Its offset.
        found: f64,
    },
    /// The skeleton has no sides.
    #[error("posture: {0}")]
    Mirror(#[from] MirrorError),
}

impl Posture {
    /// A posture from the offsets of joints, radians. A joint that has a side moves the one on the other side too, as its mirror image.
    ///
    /// # Errors
    /// When a joint is not there, or leans to one side; when both sides of one are named; when an offset is beyond 1 radian; when the
    /// skeleton has no mirror image.
    pub fn new(skeleton: &Skeleton, radians: &BTreeMap<String, f64>) -> Result<Self, PostureError> {
        let (mirror, scaling) = (mirrored_joints(skeleton)?, ActionScaling::from_skeleton(skeleton));
        let joints = skeleton.joints();
        let mut offsets = vec![0.0; joints.len()];
        let mut named: Vec<usize> = Vec::new();
        for (name, &offset) in radians {
            let Some(joint) = skeleton.joint_named(name).map(|joint| joint.index()) else {
                let known = joints.iter().map(|joint| joint.name.clone()).collect();
                return Err(PostureError::Unknown { found: name.clone(), known });
            };
            let (other, sign) = mirror.entry(joint);
            if other == joint && sign < 0.0 {
                return Err(PostureError::OneSided { found: name.clone() });
            }
            if named.contains(&other) {
                let first = joints[other].name.clone();
                return Err(PostureError::BothSides { first, second: name.clone() });
            }
            if !(-MOST_RADIANS..=MOST_RADIANS).contains(&offset) {
                return Err(PostureError::Offset { joint: name.clone(), found: offset });
            }
            named.push(joint);
            offsets[joint] = offset / f64::from(scaling.gain()[joint]);
            offsets[other] = f64::from(sign) * offsets[joint];
        }
        Ok(Self { offsets })
    }

    /// The same; `None` where no joint is named.
    ///
    /// # Errors
    /// As [`Posture::new`].
    pub fn of(skeleton: &Skeleton, radians: &BTreeMap<String, f64>) -> Result<Option<Self>, PostureError> {
        if radians.is_empty() { Ok(None) } else { Self::new(skeleton, radians).map(Some) }
    }

    /// Adds the offsets to the output biases of a policy, which come last of its parameters.
    ///
    /// # Panics
    /// When there are fewer parameters than joints.
    pub fn apply(&self, parameters: &mut [f64]) {
        let first = parameters.len() - self.offsets.len();
        parameters[first..].iter_mut().zip(&self.offsets).for_each(|(bias, offset)| *bias += offset);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn posture(radians: &[(&str, f64)]) -> Result<Posture, PostureError> {
        let radians = radians.iter().map(|(joint, offset)| ((*joint).to_owned(), *offset)).collect();
        Posture::new(&Skeleton::humanoid(), &radians)
    }

    #[test]
    fn both_sides_move_alike() {
        let posture = posture(&[("abdomen_y", 0.1), ("right_hip_x", 0.2), ("left_knee", -0.3)]).unwrap();
        let skeleton = Skeleton::humanoid();
        let scaling = ActionScaling::from_skeleton(&skeleton);
        let radians = |name: &str| {
            let joint = skeleton.joint_named(name).unwrap().index();
            (1000.0 * posture.offsets[joint] * f64::from(scaling.gain()[joint])).round() / 1000.0
        };
        let names = ["abdomen_y", "right_hip_x", "left_hip_x", "left_knee", "right_knee", "neck_y"];
        assert_eq!(names.map(radians), [0.1, 0.2, -0.2, -0.3, -0.3, 0.0]);
    }

    #[test]
    fn output_biases_get_it() {
        let mut parameters = vec![0.5; 100];
        posture(&[("neck_y", 0.1)]).unwrap().apply(&mut parameters);
        let neck = Skeleton::humanoid().joint_named("neck_y").unwrap().index();
        let changed: Vec<usize> = (0..100).filter(|index| parameters[*index] != 0.5).collect();
        assert_eq!(changed, [72 + neck]);
    }

    #[test]
    fn what_does_not_fit_is_named() {
        for (radians, named) in [
            (&[("tail", 0.1)][..], "expected one of abdomen_x, abdomen_y"),
            (&[("abdomen_x", 0.1)], "move alike on both sides, found abdomen_x"),
            (&[("left_knee", 0.1), ("right_knee", 0.1)], "one side of left_knee"),
            (&[("neck_y", 1.5)], "radians from -1 to 1 for neck_y, found 1.5"),
            (&[("neck_y", f64::NAN)], "found NaN"),
        ] {
            let error = posture(radians).unwrap_err().to_string();
            assert!(error.starts_with("posture: ") && error.contains(named), "{error}");
        }
    }
}
