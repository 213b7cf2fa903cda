//! Why a world can't be made or changed.

use playground::SceneFileError;

/// What stops a [`Simulation`](super::Simulation) from being made or changed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SimError {
    /// The body, the ground or a setting.
    #[error(transparent)]
    Model(#[from] physics::ModelError),
    /// The threads of the crowd.
    #[error(transparent)]
    Crowd(#[from] physics_bridge::CrowdError),
    /// A start that no character can take.
    #[error(transparent)]
    Pose(#[from] physics_bridge::PoseError),
    /// Settings of another ground.
    #[error(transparent)]
    Settings(#[from] physics::ModelMismatch),
    /// What stands in a shared world.
    #[error(transparent)]
    World(Box<physics_bridge::WorldError>),
    /// The scene inside the demo.
    #[error(transparent)]
    Scene(Box<SceneFileError>),
    /// What the playground is not for.
    #[error("{said}")]
    NotInPlayground {
        /// What it is for, or where the other thing is.
        said: &'static str,
    },
    /// Too many or too few characters for the playground.
    #[error("expected 1 to {most} characters in the playground, found {found}")]
    PlaygroundCharacters {
        /// Places to start from.
        most: usize,
        /// What was asked for.
        found: usize,
    },
    /// A comparison elsewhere, or of other characters than one a mode.
    #[error(
        "expected {modes} characters on the empty floor to compare blend modes, found {found} or a playground"
    )]
    Comparison {
        /// Blend modes.
        modes: usize,
        /// Characters that were asked for.
        found: usize,
    },
    /// Too many or too few characters.
    #[error("expected 1 to {} characters, found {found}", super::MAX_CHARACTERS)]
    Characters {
        /// What was asked for.
        found: usize,
    },
}

impl From<physics_bridge::WorldError> for SimError {
    fn from(error: physics_bridge::WorldError) -> Self {
        Self::World(Box::new(error))
    }
}

impl From<SceneFileError> for SimError {
    fn from(error: SceneFileError) -> Self {
        Self::Scene(Box::new(error))
    }
}
