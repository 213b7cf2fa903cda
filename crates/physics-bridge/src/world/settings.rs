//! Changing gravity, friction and strength while a world runs.

use mujoco_rs::wrappers::mj_model::{MjModel, MjtObjBase};

use super::World;
use super::handle::CharacterHandle;
use crate::description::layout::Layout;
use crate::description::mjcf::FLOOR;
use crate::description::model::Model;
use crate::description::world_error::WorldError;

impl World {
    /// Applies the gravity and friction of `ground` from the next step on. It is made by [`Model::with_settings`] of
    /// [`World::ground`]. Snapshots do not hold settings.
    ///
    /// # Errors
    /// When it has another ground; the world is then unchanged.
    pub fn set_ground(&mut self, ground: &Model) -> Result<(), WorldError> {
        if !self.ground.shares_ground_with(ground) {
            return Err(WorldError::OtherModel);
        }
        let factor = f64::from(ground.settings().friction);
        let floor = ground.physics().name_to_id(MjtObjBase::mjOBJ_GEOM, FLOOR);
        let own = floor.map_or(factor, |floor| ground.physics().geom_friction()[floor][0]);
        // SAFETY: only gravity and friction are written; no size, index or address changes.
        let model = unsafe { self.data.model_mut() };
        model.opt_mut().gravity = ground.physics().opt().gravity;
        for geom in 0..self.places.frictions.len() {
            let of_ground = model.geom_bodyid()[geom] == 0;
            model.geom_friction_mut()[geom][0] =
                if of_ground { own } else { factor * self.places.frictions[geom] };
        }
        self.ground = ground.clone();
        self.data.step1(); // contacts stay: they are of the last substep
        Ok(())
    }

    /// Applies the strength of `model` to a character from the next step on. It is made by [`Model::with_settings`] of
    /// [`World::model`].
    ///
    /// # Errors
    /// When the handle is stale or it is another model; the world is then unchanged.
    pub fn set_model(&mut self, character: CharacterHandle, model: &Model) -> Result<(), WorldError> {
        let index = self.scene.characters.index_of(character)?;
        if !self.scene.characters.at(index).shares_ground_with(model) {
            return Err(WorldError::OtherModel);
        }
        // SAFETY: only gains and force limits are written; no size, index or address changes.
        let physics = unsafe { self.data.model_mut() };
        copy_motors(physics, &self.places.character(index).layout, model);
        *self.scene.characters.at_mut(index) = model.clone();
        Ok(())
    }
}

/// Gives the motors of a character the stiffness and the greatest torque that they have in its own model.
pub(super) fn copy_motors(physics: &mut MjModel, layout: &Layout, model: &Model) {
    let own = model.physics();
    for (to, from) in layout.joints.iter().zip(&model.layout().joints) {
        let (to, from) = (to.actuator, from.actuator);
        // SAFETY: both are motors of fixed gain, whose gain parameters MuJoCo uses as an index of nothing.
        unsafe { physics.actuator_gainprm_mut()[to] = own.actuator_gainprm()[from] };
        physics.actuator_biasprm_mut()[to] = own.actuator_biasprm()[from];
        physics.actuator_forcerange_mut()[to] = own.actuator_forcerange()[from];
    }
}
