//! Why a world can't be made or changed.

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
    /// Too many or too few characters.
    #[error("expected 1 to {} characters, found {found}", super::MAX_CHARACTERS)]
    Characters {
        /// What was asked for.
        found: usize,
    },
}
