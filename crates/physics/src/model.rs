//! The body of a character, its ground and its settings, in either engine.

use std::sync::Arc;

use physics_bridge::Terrain;
use policy_core::Skeleton;
use policy_core::contract::Settings;

use crate::Engine;

/// Why a model can't be made or changed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// MuJoCo refuses it.
    #[error(transparent)]
    Mujoco(#[from] physics_bridge::ModelError),
    /// Rapier refuses it.
    #[error("in Rapier: {0}")]
    Rapier(#[from] physics_rapier::ModelError),
}

/// The model is of another character or engine.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("expected a model made of the character's own, found another")]
#[non_exhaustive]
pub struct ModelMismatch;

/// A character's body, ground and settings, shared by many characters. Cloning copies a few pointers.
#[derive(Clone, Debug)]
pub struct Model {
    described: physics_bridge::Model,
    /// `None` in MuJoCo.
    rapier: Option<physics_rapier::Model>,
}

impl Model {
    /// The body, ground and settings of `described`, in an engine.
    ///
    /// # Errors
    /// When Rapier can't load its MJCF.
    pub fn new(described: &physics_bridge::Model, engine: Engine) -> Result<Self, ModelError> {
        let described = described.clone();
        let rapier = match engine {
            Engine::Mujoco => None,
            Engine::Rapier => {
                let (mjcf, skeleton) = (described.mjcf(), Arc::clone(described.skeleton()));
                let bare = physics_rapier::Model::from_mjcf_at_rate(mjcf, skeleton, described.control_hz())?;
                Some(like(&bare, &described)?)
            }
        };
        Ok(Self { described, rapier })
    }

    /// The engine.
    #[must_use]
    pub fn engine(&self) -> Engine {
        if self.rapier.is_some() { Engine::Rapier } else { Engine::Mujoco }
    }

    /// Shapes, terrain and settings, the same in either engine.
    #[must_use]
    pub fn described(&self) -> &physics_bridge::Model {
        &self.described
    }

    /// Bodies, hinges and roles.
    #[must_use]
    pub fn skeleton(&self) -> &Arc<Skeleton> {
        self.described.skeleton()
    }

    /// The same character on another ground, with the present settings.
    ///
    /// # Errors
    /// When a number of the terrain is out of its range.
    pub fn with_terrain(&self, terrain: Terrain) -> Result<Self, ModelError> {
        self.changed(self.described.with_terrain(terrain)?)
    }

    /// The same character on the same ground, with other settings.
    ///
    /// # Errors
    /// When a setting is out of its range.
    pub fn with_settings(&self, settings: Settings) -> Result<Self, ModelError> {
        self.changed(self.described.with_settings(settings)?)
    }

    fn changed(&self, described: physics_bridge::Model) -> Result<Self, ModelError> {
        let rapier = self.rapier.as_ref().map(|rapier| like(rapier, &described)).transpose()?;
        Ok(Self { described, rapier })
    }

    pub(crate) fn rapier(&self) -> Option<&physics_rapier::Model> {
        self.rapier.as_ref()
    }
}

/// The body of `rapier` on the ground and with the settings of `described`.
fn like(
    rapier: &physics_rapier::Model,
    described: &physics_bridge::Model,
) -> Result<physics_rapier::Model, ModelError> {
    let on_ground = rapier.with_ground(described.height_field());
    on_ground.with_settings(described.settings()).map_err(|error| ModelError::Mujoco(error.into()))
}
