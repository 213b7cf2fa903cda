//! Why a replay file is refused.

use std::path::PathBuf;

use policy_core::training::SkeletonError;

use super::super::SnapshotMismatch;
use super::{FORMAT, LARGEST, VERSION};
use crate::description::file::quoted;
use crate::description::model_error::ModelError;

/// Why a replay file can't be read, written or run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReplayFileError {
    /// The file can't be read or written.
    #[error("cannot access the replay file {}", path.display())]
    Access {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The bytes are not the JSON of a replay file.
    #[error("expected the JSON of a replay file: {message}")]
    Json {
        /// What is wrong, with line and column.
        message: String,
    },
    /// Something else, or from another version.
    #[error("expected {FORMAT:?} of version {VERSION}, found {format:?} of version {version}")]
    Format {
        /// What the file says it is.
        format: String,
        /// Its version.
        version: u32,
    },
    /// The state is not hexadecimal doubles.
    #[error("expected 16 hexadecimal digits at character {offset} of state, found something else")]
    State {
        /// Where, in characters.
        offset: usize,
    },
    /// A number of the state can't be simulated.
    #[error("expected a finite number below {LARGEST:e} in size as number {index} of state, found {found}")]
    Number {
        /// Which, from 0.
        index: usize,
        /// The number.
        found: f64,
    },
    /// A push can't be simulated.
    #[error("expected a finite force of at most 1 MN for each body in pushes, found others")]
    Pushes,
    /// The control rate is none.
    #[error("expected control_hz from 1 to 1000, found {found}")]
    ControlRate {
        /// Control ticks per second.
        found: f32,
    },
    /// The skeleton names a body that it does not have, or is none.
    #[error("expected a body of the skeleton, found \"{found}\"")]
    Body {
        /// Name in the file.
        found: String,
    },
    /// The bodies and hinges make no skeleton.
    #[error("in the skeleton of the replay file: {}", quoted(&error.to_string()))]
    Skeleton {
        /// What is wrong with it.
        error: SkeletonError,
    },
    /// The model can't be compiled.
    #[error("in the model of the replay file: {error}")]
    Model {
        /// Why.
        error: ModelError,
    },
    /// The state does not belong to the model.
    #[error("in the state of the replay file: {error}")]
    Snapshot {
        /// Why.
        error: SnapshotMismatch,
    },
}
