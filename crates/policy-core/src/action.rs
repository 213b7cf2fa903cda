//! From a policy's 28 normalised numbers to joint targets in radians.

use crate::body::DOF_COUNT;
use crate::state::JointTargets;

/// Per joint: `target = centre + gain * action`, radians.
#[derive(Clone, Debug, PartialEq)]
pub struct ActionScaling {
    centre: [f32; DOF_COUNT],
    gain: [f32; DOF_COUNT],
}

/// Why an [`ActionScaling`] can't be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ActionScalingError {
    /// A centre or gain is not finite, or a gain is not positive.
    #[error(
        "expected a finite centre and a finite positive gain for joint {joint}, found {centre} and {gain}"
    )]
    Number {
        /// Index of the joint.
        joint: usize,
        /// Its centre, radians.
        centre: f32,
        /// Its gain, radians.
        gain: f32,
    },
}

impl ActionScaling {
    /// Scaling with the given centre and gain of each joint, radians.
    ///
    /// # Errors
    /// When a number is not finite or a gain is not positive.
    pub fn from_centre_and_gain(
        centre: [f32; DOF_COUNT],
        gain: [f32; DOF_COUNT],
    ) -> Result<Self, ActionScalingError> {
        for joint in 0..DOF_COUNT {
            let (c, g) = (centre[joint], gain[joint]);
            if !c.is_finite() || !g.is_finite() || g <= 0.0 {
                return Err(ActionScalingError::Number { joint, centre: c, gain: g });
            }
        }
        Ok(Self { centre, gain })
    }

    /// Scaling from joint limits in radians, as in AMP: elbows and knees about the middle of their range,
    /// `1.2 * half_range`; the other joints about zero, `min(1.2 * max(|low|, |high|), pi)`.
    ///
    /// # Errors
    /// When a limit is not finite or a range is empty.
    pub fn from_joint_limits(
        low: [f32; DOF_COUNT],
        high: [f32; DOF_COUNT],
    ) -> Result<Self, ActionScalingError> {
        let (mut centre, mut gain) = ([0.0; DOF_COUNT], [0.0; DOF_COUNT]);
        for (joint, name) in crate::body::JOINT_NAMES.iter().enumerate() {
            let (lo, hi) = (low[joint], high[joint]);
            if name.ends_with("elbow") || name.ends_with("knee") {
                centre[joint] = 0.5 * (lo + hi);
                gain[joint] = 1.2 * 0.5 * (hi - lo);
            } else {
                gain[joint] = (1.2 * lo.abs().max(hi.abs())).min(core::f32::consts::PI);
            }
        }
        Self::from_centre_and_gain(centre, gain)
    }

    /// Centre of each joint, radians.
    #[must_use]
    pub fn centre(&self) -> &[f32; DOF_COUNT] {
        &self.centre
    }

    /// Gain of each joint, radians.
    #[must_use]
    pub fn gain(&self) -> &[f32; DOF_COUNT] {
        &self.gain
    }

    /// Writes the joint targets of an action. Any finite action is allowed; [-1, 1] is the usual range.
    pub fn targets_into(&self, action: &[f32; DOF_COUNT], out: &mut JointTargets) {
        for (joint, target) in out.0.iter_mut().enumerate() {
            *target = self.centre[joint] + self.gain[joint] * action[joint];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn knees_turn_about_their_middle_and_hips_about_zero() {
        let (mut low, mut high) = ([-1.0; DOF_COUNT], [0.5; DOF_COUNT]);
        let knee = crate::JOINT_NAMES.iter().position(|n| *n == "left_knee").unwrap();
        (low[knee], high[knee]) = (0.0, 2.0);
        let scaling = ActionScaling::from_joint_limits(low, high).unwrap();
        let mut targets = JointTargets::default();
        scaling.targets_into(&[0.5; DOF_COUNT], &mut targets);
        assert!((targets.0[knee] - 1.6).abs() < 1e-6);
        assert!((targets.0[0] - 0.6).abs() < 1e-6);
    }

    #[test]
    fn an_empty_range_is_refused() {
        assert!(ActionScaling::from_joint_limits([0.0; DOF_COUNT], [0.0; DOF_COUNT]).is_err());
    }
}
