//! The best time over a course: a file beside the settings.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::files;

/// Largest file, bytes.
const MOST_BYTES: u64 = 4096;

/// The best run so far.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BestTime {
    /// Time on the clock, seconds, above 0.
    pub secs: f32,
    /// Falls in that run.
    pub falls: u32,
}

/// Why a best time can't be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BestTimeError {
    /// The file.
    #[error("the best time in {}: {source}", path.display())]
    File {
        /// Which file.
        path: PathBuf,
        /// What is wrong.
        source: files::ReadError,
    },
    /// Its text.
    #[error("expected a best time such as (secs: 61.5, falls: 0) in {}, found something else", path.display())]
    Text {
        /// Which file.
        path: PathBuf,
    },
}

impl BestTime {
    /// The file of a scene, in the folder of the settings file `settings`. The name of the scene is a plain word.
    #[must_use]
    pub fn file_beside(settings: &Path, scene: &str) -> PathBuf {
        settings.with_file_name(format!("best-{scene}.ron"))
    }

    /// Reads it; `None` when there is no file.
    ///
    /// # Errors
    /// When the file can't be read or holds something else.
    pub fn load(path: &Path) -> Result<Option<Self>, BestTimeError> {
        if !path.exists() {
            return Ok(None);
        }
        let bytes = files::read(path, MOST_BYTES)
            .map_err(|source| BestTimeError::File { path: path.to_owned(), source })?;
        Self::from_bytes(path, &bytes).map(Some)
    }

    /// Reads the bytes of such a file; `path` is only named in errors.
    ///
    /// # Errors
    /// When they hold something else.
    pub fn from_bytes(path: &Path, bytes: &[u8]) -> Result<Self, BestTimeError> {
        let best: Option<Self> = std::str::from_utf8(bytes).ok().and_then(|text| ron::from_str(text).ok());
        match best {
            Some(best) if best.secs.is_finite() && best.secs > 0.0 => Ok(best),
            _ => Err(BestTimeError::Text { path: path.to_owned() }),
        }
    }

    /// The text of a file.
    #[must_use]
    pub fn to_text(&self) -> String {
        format!("(secs: {:?}, falls: {})\n", self.secs, self.falls)
    }

    /// Writes it.
    ///
    /// # Errors
    /// When the file can't be written; it is then as it was.
    pub fn save(&self, path: &Path) -> Result<(), BestTimeError> {
        files::write(path, self.to_text().as_bytes())
            .map_err(|source| BestTimeError::File { path: path.to_owned(), source: source.into() })
    }

    /// True when a run is better than the best so far.
    #[must_use]
    pub fn beats(&self, best: Option<Self>) -> bool {
        best.is_none_or(|best| self.secs < best.secs)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_kept_and_what_is_broken_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = BestTime::file_beside(&folder.path().join("layout.ron"), "playground");
        assert_eq!(BestTime::load(&path).unwrap(), None);
        let best = BestTime { secs: 61.533_333, falls: 2 };
        best.save(&path).unwrap();
        assert_eq!(BestTime::load(&path).unwrap(), Some(best));
        for broken in ["", "(secs: 0, falls: 0)", "(secs: NaN, falls: 0)", "(secs: 5)", "\u{1f}"] {
            std::fs::write(&path, broken).unwrap();
            assert!(matches!(BestTime::load(&path), Err(BestTimeError::Text { .. })), "{broken:?}");
        }
        let faster = BestTime { secs: 60.0, falls: 5 };
        assert!(faster.beats(Some(best)) && faster.beats(None) && !best.beats(Some(faster)));
    }
}
