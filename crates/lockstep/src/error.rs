//! Why an arena can't be made, stepped or restored.

use physics_rapier::{ModelError, WorldError};
use playground::SceneFileError;
use policy_core::{PackError, StateError};
use replay::ReplayError;

use crate::scene::MOST_CRATES;

/// Why an [`Arena`](crate::Arena) can't be made, stepped or restored. It is unchanged then.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ArenaError {
    /// The bytes are no pack.
    #[error(transparent)]
    Pack(#[from] PackError),
    /// The pack's body can't be simulated.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A character or prop can't be placed.
    #[error(transparent)]
    World(#[from] WorldError),
    /// Too many or too few players.
    #[error("expected 1 to {most} players, found {found}")]
    Players {
        /// Most in this scene.
        most: usize,
        /// What was asked for.
        found: usize,
    },
    /// Too many crates.
    #[error("expected at most {MOST_CRATES} crates, found {found}")]
    Crates {
        /// What was asked for.
        found: usize,
    },
    /// The playground can't be read.
    #[error(transparent)]
    Layout(#[from] SceneFileError),
    /// A scene that no arena has.
    #[error(
        "expected a replay of the scene arena/CRATES or of the playground of this version, found {found:?}"
    )]
    Scene {
        /// The name in the header.
        found: String,
    },
    /// More or fewer pads than players.
    #[error("expected {expected} pads, one for each player, found {found}")]
    Pads {
        /// Players.
        expected: usize,
        /// Pads.
        found: usize,
    },
    /// The state was saved by another arena.
    #[error("expected a state that this arena saved, found one of another")]
    State,
    /// A controller's part of the state.
    #[error(transparent)]
    Controller(#[from] StateError),
    /// A replay of something else.
    #[error(transparent)]
    Replay(#[from] ReplayError),
}
