//! Settings, applied to a compiled model.

use mujoco_rs::wrappers::mj_data::MjData;
use mujoco_rs::wrappers::mj_model::MjModel;
use policy_core::contract::Settings;

use super::layout::Layout;
use super::model_error::ModelError;

/// A copy of `base` with the settings applied.
pub(crate) fn apply(settings: &Settings, base: &MjModel, layout: &Layout) -> Result<MjModel, ModelError> {
    settings.check()?;
    let mut model = base.clone();
    model.opt_mut().gravity.iter_mut().for_each(|g| *g *= f64::from(settings.gravity));
    model.geom_friction_mut().iter_mut().for_each(|[slide, ..]| *slide *= f64::from(settings.friction));
    layout.scale_strength(&mut model, settings.strength.into());
    Ok(if settings.mass == 1.0 { model } else { with_mass(model, settings.mass.into()) })
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
