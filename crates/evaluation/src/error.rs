//! Why a pack can't be measured.

use physics::ModelError;
use physics_bridge::WorldError;
use playground::SceneFileError;

/// Why a pack can't be measured.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EvaluationError {
    /// The model can't be set on another ground, or changed.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The character can't be put into a shared world.
    #[error(transparent)]
    World(#[from] WorldError),
    /// The playground is none.
    #[error(transparent)]
    Scene(#[from] SceneFileError),
}
