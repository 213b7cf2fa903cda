//! From a policy's normalised numbers to joint targets in radians.

use alloc::vec::Vec;

use crate::skeleton::Skeleton;
use crate::state::JointTargets;

/// Largest centre and gain, radians. Far beyond any joint, and far below what makes a target infinite.
const MOST_RADIANS: f32 = 1000.0;

/// Per joint: `target = centre + gain * action`, radians.
#[derive(Clone, Debug, PartialEq)]
pub struct ActionScaling {
    centre: Vec<f32>,
    gain: Vec<f32>,
}

/// Why an [`ActionScaling`] can't be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ActionScalingError {
    /// A centre is beyond 1000 rad, a gain is not positive or beyond 1000 rad, or one is not a number.
    #[error(
        "expected action_centre from -{MOST_RADIANS} to {MOST_RADIANS} and a positive action_gain up to {MOST_RADIANS} for \
         joint {joint}, found {centre} and {gain}"
    )]
    Number {
        /// Index of the joint.
        joint: usize,
        /// Its centre, radians.
        centre: f32,
        /// Its gain, radians.
        gain: f32,
    },
    /// There are more or fewer gains than centres.
    #[error("expected as many gains as centres ({centres}), found {gains}")]
    Count {
        /// Number of centres.
        centres: usize,
        /// Number of gains.
        gains: usize,
    },
}

impl ActionScaling {
    /// Scaling with the given centre and gain of each joint, radians.
    ///
    /// # Errors
    /// When the lengths differ, a number is not finite or beyond 1000 rad, or a gain is not positive.
    pub fn from_centre_and_gain(centre: &[f32], gain: &[f32]) -> Result<Self, ActionScalingError> {
        if centre.len() != gain.len() {
            return Err(ActionScalingError::Count { centres: centre.len(), gains: gain.len() });
        }
        for (joint, (&c, &g)) in centre.iter().zip(gain).enumerate() {
            let fits = c.abs() <= MOST_RADIANS && g > 0.0 && g <= MOST_RADIANS;
            if !fits {
                return Err(ActionScalingError::Number { joint, centre: c, gain: g });
            }
        }
        Ok(Self { centre: centre.into(), gain: gain.into() })
    }

    /// Scaling from the ranges of a skeleton's joints, as in AMP. A joint that bends to one side only, such as a knee,
    /// turns about the middle of its range by `1.2 * half_range`; the others about zero by
    /// `min(1.2 * max(|low|, |high|), pi)`.
    #[must_use]
    pub fn from_skeleton(skeleton: &Skeleton) -> Self {
        let scaled = |[low, high]: [f32; 2]| {
            if low >= 0.0 || high <= 0.0 {
                (0.5 * (low + high), 1.2 * 0.5 * (high - low))
            } else {
                (0.0, (1.2 * low.abs().max(high.abs())).min(core::f32::consts::PI))
            }
        };
        let (centre, gain) = skeleton.joints().iter().map(|joint| scaled(joint.range)).unzip();
        Self { centre, gain }
    }

    /// Centre of each joint, radians.
    #[must_use]
    pub fn centre(&self) -> &[f32] {
        &self.centre
    }

    /// Gain of each joint, radians.
    #[must_use]
    pub fn gain(&self) -> &[f32] {
        &self.gain
    }

    /// Writes the joint targets of an action. Any finite action is allowed; [-1, 1] is the usual range. Does not allocate.
    ///
    /// # Panics
    /// When `action` or `out` has another length than the scaling.
    pub fn targets_into(&self, action: &[f32], out: &mut JointTargets) {
        assert_eq!(
            (action.len(), out.len()),
            (self.centre.len(), self.centre.len()),
            "joints of the scaling"
        );
        for (((target, centre), gain), action) in out.iter_mut().zip(&self.centre).zip(&self.gain).zip(action)
        {
            *target = centre + gain * action;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn knees_turn_about_their_middle_and_hips_about_zero() {
        let skeleton = Skeleton::humanoid();
        let joint = |name: &str| skeleton.joint_named(name).unwrap().index();
        let scaling = ActionScaling::from_skeleton(&skeleton);
        let mut targets = JointTargets::new(&skeleton);
        scaling.targets_into(&[0.5; 28], &mut targets);
        let degrees = |name: &str| targets[joint(name)].to_degrees();
        assert!((degrees("left_knee") - (80.0 + 0.5 * 96.0)).abs() < 1e-4);
        assert!((degrees("right_elbow") - (-80.0 + 0.5 * 96.0)).abs() < 1e-4);
        assert!((degrees("abdomen_x") - 0.5 * 72.0).abs() < 1e-4);
    }

    #[test]
    fn bad_numbers_are_refused() {
        use ActionScalingError::{Count, Number};
        let made = ActionScaling::from_centre_and_gain;
        assert!(matches!(made(&[0.0, 0.0], &[1.0, 0.0]), Err(Number { joint: 1, .. })));
        assert!(matches!(made(&[f32::NAN], &[1.0]), Err(Number { joint: 0, .. })));
        assert!(matches!(made(&[0.0, 3e38], &[1.0, 1.0]), Err(Number { joint: 1, .. })));
        assert!(matches!(made(&[0.0], &[3e38]), Err(Number { joint: 0, .. })));
        assert!(made(&[-1000.0], &[1000.0]).is_ok());
        assert!(matches!(made(&[0.0], &[]), Err(Count { centres: 1, gains: 0 })));
    }
}
