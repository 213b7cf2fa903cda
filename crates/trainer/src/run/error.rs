//! Why a run can't continue.

use std::path::PathBuf;

use super::lock::Holder;
use crate::checkpoint::CheckpointError;

/// Why a run can't be opened, advanced or saved.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// A file or folder can't be used.
    #[error("cannot use {}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// Another trainer writes there.
    #[error(
        "{}: expected a run that no other trainer writes, found one held by {}",
        folder.display(),
        holder.as_ref().map_or_else(|| "an unnamed process".to_owned(), Holder::to_string)
    )]
    Locked {
        /// The run's folder.
        folder: PathBuf,
        /// Who holds it.
        holder: Option<Holder>,
    },
    /// A run is there, and the caller asked for neither of the two ways to meet it.
    #[error(
        "{}: expected no run, found one: continue it with --resume, or delete and restart it with --overwrite",
        folder.display()
    )]
    Exists {
        /// The run's folder.
        folder: PathBuf,
    },
    /// Neither checkpoint of the run can be loaded.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// Training diverged.
    #[error("after {samples} samples: expected finite parameters and moments of {role}, found others")]
    NotFinite {
        /// Role of the network.
        role: String,
        /// Samples so far.
        samples: u64,
    },
}
