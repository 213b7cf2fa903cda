//! What a user may change while characters move: gravity, friction, strength, mass.

use mujoco_rs::wrappers::mj_data::MjData;
use mujoco_rs::wrappers::mj_model::MjModel;
use serde::{Deserialize, Serialize};

use super::layout::Layout;
use super::model_error::ModelError;

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
    /// Of the mass and inertia of every body, in [0.2, 5].
    #[serde(default = "unchanged")]
    pub mass: f32,
}

/// Replay files of earlier versions have no mass.
fn unchanged() -> f32 {
    1.0
}

impl Default for Settings {
    fn default() -> Self {
        Self { gravity: 1.0, friction: 1.0, strength: 1.0, mass: 1.0 }
    }
}

impl Settings {
    /// A copy of `base` with the settings applied.
    pub(crate) fn apply_to(&self, base: &MjModel, layout: &Layout) -> Result<MjModel, ModelError> {
        for (field, found, least) in [
            ("gravity", self.gravity, 0.0),
            ("friction", self.friction, 0.0),
            ("strength", self.strength, 0.0),
            ("mass", self.mass, 0.2),
        ] {
            if !(least..=5.0).contains(&found) {
                return Err(ModelError::Setting { field, least, most: 5.0, found });
            }
        }
        let mut model = base.clone();
        model.opt_mut().gravity.iter_mut().for_each(|g| *g *= f64::from(self.gravity));
        model.geom_friction_mut().iter_mut().for_each(|[slide, ..]| *slide *= f64::from(self.friction));
        layout.scale_strength(&mut model, self.strength.into());
        Ok(if self.mass == 1.0 { model } else { with_mass(model, self.mass.into()) })
    }
}

/// Multiplies masses and inertias, and lets MuJoCo recompute what follows from them.
fn with_mass(model: MjModel, factor: f64) -> MjModel {
    let mut data = MjData::new(Box::new(model.clone()));
    // SAFETY: only masses and inertias are written; no size, index or address changes.
    let scaled = unsafe { data.model_mut() };
    scaled.body_mass_mut().iter_mut().for_each(|mass| *mass *= factor);
    scaled.body_inertia_mut().iter_mut().flatten().for_each(|inertia| *inertia *= factor);
    data.set_const();
    *data.swap_model(Box::new(model))
}
