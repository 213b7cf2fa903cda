//! The files of a run: lock, recipe, seed, metrics, the newest checkpoint and the one before it.

use std::path::{Path, PathBuf};

use files::{remove_unfinished, write_atomically};

use super::RunError;
use super::lock::{Holder, RunLock};
use crate::checkpoint::{Checkpoint, CheckpointError};
use crate::lineage::STEP_FILE;

/// The newest checkpoint.
pub const CHECKPOINT: &str = "checkpoint.safetensors";
/// The one before it.
pub const PREVIOUS: &str = "checkpoint.previous.safetensors";
/// Where a newest checkpoint goes that can't be read.
const TORN: &str = "checkpoint.torn.safetensors";
/// One line an iteration.
pub const METRICS_FILE: &str = "metrics.csv";

/// Is there where a run begins by itself: before its first checkpoint it must not continue a kept one.
const ANEW: &str = "anew.txt";

/// What to do about a run that is there already.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Existing {
    /// Refuse it.
    #[default]
    Refuse,
    /// Continue it.
    Resume,
    /// Delete it and start anew.
    Overwrite,
}

/// A run's checkpoint and where it was.
#[derive(Debug)]
pub struct Loaded {
    /// The checkpoint.
    pub checkpoint: Checkpoint,
    /// Its file.
    pub path: PathBuf,
    /// Why the newest one was not taken, if it was there and torn.
    pub torn: Option<CheckpointError>,
}

/// The newest whole checkpoint in a run's folder; `None` when there is no checkpoint at all.
///
/// # Errors
/// When there are checkpoints and none can be read.
pub fn newest_checkpoint(folder: &Path) -> Result<Option<Loaded>, CheckpointError> {
    let (newest, previous) = (folder.join(CHECKPOINT), folder.join(PREVIOUS));
    let torn = match newest.exists().then(|| Checkpoint::load(&newest)) {
        Some(Ok(checkpoint)) => return Ok(Some(Loaded { checkpoint, path: newest, torn: None })),
        Some(Err(error)) => Some(error),
        None => None,
    };
    match (previous.exists().then(|| Checkpoint::load(&previous)), torn) {
        (Some(Ok(checkpoint)), torn) => Ok(Some(Loaded { checkpoint, path: previous, torn })),
        (_, Some(error)) | (Some(Err(error)), None) => Err(error),
        (None, None) => Ok(None),
    }
}

/// True when a folder holds a run.
#[must_use]
pub fn holds_a_run(folder: &Path) -> bool {
    [CHECKPOINT, PREVIOUS, METRICS_FILE].iter().any(|name| folder.join(name).exists())
}

/// A run's folder, locked for this process.
#[derive(Debug)]
pub struct RunFolder {
    path: PathBuf,
    lock: RunLock,
}

impl RunFolder {
    /// Makes the folder if it is not there, locks it, and removes what a crash left unfinished. Deletes no run, see
    /// [`RunFolder::clear`].
    ///
    /// # Errors
    /// When another trainer holds it, a run is there with [`Existing::Refuse`], or the folder can't be written.
    pub fn open(path: PathBuf, existing: Existing) -> Result<Self, RunError> {
        let io = |source| RunError::Io { path: path.clone(), source };
        std::fs::create_dir_all(&path).map_err(io)?;
        let lock = RunLock::take(&path)?;
        remove_unfinished(&path).map_err(io)?;
        if existing == Existing::Refuse && holds_a_run(&path) {
            return Err(RunError::Exists { folder: path });
        }
        Ok(Self { path, lock })
    }

    /// Deletes the checkpoints and metrics that are there, and what says which step of a lineage made them.
    ///
    /// # Errors
    /// When a file can't be removed.
    pub fn clear(&self) -> Result<(), RunError> {
        let files = [CHECKPOINT, PREVIOUS, TORN, METRICS_FILE, STEP_FILE, ANEW];
        files.iter().try_for_each(|name| remove(&self.path.join(name)))
    }

    /// Clears those of these folders that are there. No folder is cleared unless all of them can be locked.
    ///
    /// # Errors
    /// When another trainer holds one, or a file can't be removed.
    pub fn clear_all(paths: impl IntoIterator<Item = PathBuf>) -> Result<(), RunError> {
        let there = paths.into_iter().filter(|path| path.is_dir());
        let open = there.map(|path| Self::open(path, Existing::Overwrite)).collect::<Result<Vec<_>, _>>()?;
        open.iter().try_for_each(Self::clear)
    }

    /// Notes that the run of this folder begins by itself, see [`RunFolder::begins_anew`].
    ///
    /// # Errors
    /// When the folder can't be written.
    pub fn begin_anew(&self) -> Result<(), RunError> {
        self.write(ANEW, "This run continues no kept checkpoint.\n")
    }

    /// True for the folder of a run that continues no kept checkpoint, also where it has none of its own yet.
    #[must_use]
    pub fn begins_anew(path: &Path) -> bool {
        path.join(ANEW).exists()
    }

    /// Drops the rows of the metrics that come after so many samples: those that a killed run wrote after its last checkpoint.
    ///
    /// # Errors
    /// When the metrics can't be read or written.
    pub fn cut_metrics(&self, samples: u64) -> Result<(), RunError> {
        let path = self.path.join(METRICS_FILE);
        let text = std::fs::read_to_string(&path).map_err(|source| RunError::Io { path, source })?;
        let of_row = |row: &str| row.split(',').next().and_then(|count| count.parse::<u64>().ok());
        let keeps = |(index, row): &(usize, &str)| *index == 0 || of_row(row).is_some_and(|s| s <= samples);
        let kept: String =
            text.lines().enumerate().filter(keeps).map(|(_, row)| format!("{row}\n")).collect();
        if kept == text { Ok(()) } else { self.write(METRICS_FILE, &kept) }
    }

    /// Where it is.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The trainer that crashed here before, if one did.
    #[must_use]
    pub fn crashed(&self) -> Option<&Holder> {
        self.lock.crashed.as_ref()
    }

    /// The newest whole checkpoint. One that is torn is set aside, so that it never replaces a whole one.
    ///
    /// # Errors
    /// When there are checkpoints and none can be read, or the torn one can't be moved.
    pub fn load(&self) -> Result<Option<Loaded>, RunError> {
        let loaded = newest_checkpoint(&self.path)?;
        if loaded.as_ref().is_some_and(|l| l.torn.is_some()) {
            let torn = self.path.join(CHECKPOINT);
            std::fs::rename(&torn, self.path.join(TORN))
                .map_err(|source| RunError::Io { path: torn, source })?;
        }
        Ok(loaded)
    }

    /// Writes a checkpoint; the newest one so far becomes the previous one.
    ///
    /// # Errors
    /// When the folder can't be written. Then a whole checkpoint is still there, if there was one.
    pub fn save(&self, checkpoint: &Checkpoint) -> Result<(), RunError> {
        Ok(checkpoint.save_keeping_previous(&self.path.join(CHECKPOINT), &self.path.join(PREVIOUS))?)
    }

    /// Writes another file of the run.
    ///
    /// # Errors
    /// When the folder can't be written.
    pub fn write(&self, name: &str, text: &str) -> Result<(), RunError> {
        let path = self.path.join(name);
        write_atomically(&path, text.as_bytes()).map_err(|source| RunError::Io { path, source })
    }
}

fn remove(path: &Path) -> Result<(), RunError> {
    match std::fs::remove_file(path) {
        Err(source) if source.kind() != std::io::ErrorKind::NotFound => {
            Err(RunError::Io { path: path.to_owned(), source })
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
#[path = "folder_tests.rs"]
mod tests;
