//! What a user may change while characters move: gravity, friction, strength.

use mujoco_rs::wrappers::mj_model::MjModel;
use serde::{Deserialize, Serialize};

use crate::layout::Layout;
use crate::model_error::ModelError;

/// Factors on what the MJCF says; all 1 by default, which changes no bit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// Of gravity, in [0, 5]: 0 is free fall, 0.165 the moon.
    pub gravity: f32,
    /// Of the sliding friction between everything, in [0, 5]: about 0.1 is ice.
    pub friction: f32,
    /// Of the stiffness and the greatest torque of every motor, in [0, 5]: 0 is a rag doll.
    pub strength: f32,
}

impl Default for Settings {
    fn default() -> Self {
        Self { gravity: 1.0, friction: 1.0, strength: 1.0 }
    }
}

const RANGE: std::ops::RangeInclusive<f32> = 0.0..=5.0;

impl Settings {
    /// A copy of `base` with the settings applied.
    pub(crate) fn apply_to(&self, base: &MjModel, layout: &Layout) -> Result<MjModel, ModelError> {
        for (field, found) in
            [("gravity", self.gravity), ("friction", self.friction), ("strength", self.strength)]
        {
            if !RANGE.contains(&found) {
                let (least, most) = (*RANGE.start(), *RANGE.end());
                return Err(ModelError::Setting { field, least, most, found });
            }
        }
        let mut model = base.clone();
        model.opt_mut().gravity.iter_mut().for_each(|g| *g *= f64::from(self.gravity));
        model.geom_friction_mut().iter_mut().for_each(|[slide, ..]| *slide *= f64::from(self.friction));
        let strength = f64::from(self.strength);
        for &actuator in &layout.joint_actuator {
            // SAFETY: `Layout::of` accepts only motors of fixed gain, whose first gain parameter is a
            // factor: MuJoCo uses it as an index of nothing.
            unsafe { model.actuator_gainprm_mut()[actuator][0] *= strength };
            let [_, position, velocity, ..] = &mut model.actuator_biasprm_mut()[actuator];
            *position *= strength;
            *velocity *= strength;
            model.actuator_forcerange_mut()[actuator].iter_mut().for_each(|f| *f *= strength);
        }
        Ok(model)
    }
}
