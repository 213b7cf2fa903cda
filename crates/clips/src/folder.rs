//! Finding clips by name in a folder that the caller or the environment names.

use std::path::{Path, PathBuf};

use files::read_bounded;

use super::{Clip, ClipError, deepmimic, json, npy};

/// Largest clip, bytes. An empty list of three bytes takes 24 in memory, and more while the list of them grows.
const MOST_BYTES: u64 = 24 << 20;

/// Environment variable that names the folder of clips.
pub const MOTIONS_VARIABLE: &str = "POLICY_SPACE_MOTIONS";

/// A folder of clips.
#[derive(Clone, Debug)]
pub struct ClipFolder(PathBuf);

impl ClipFolder {
    /// The given folder, or the one that [`MOTIONS_VARIABLE`] names.
    ///
    /// # Errors
    /// When neither is given; says where clips can be had.
    pub fn from_argument(argument: Option<PathBuf>) -> Result<Self, ClipError> {
        argument
            .or_else(|| std::env::var_os(MOTIONS_VARIABLE).map(PathBuf::from))
            .map(Self)
            .ok_or(ClipError::NoFolder { variable: MOTIONS_VARIABLE })
    }

    /// Reads the clip of this name, in whichever format is there.
    ///
    /// # Errors
    /// When there is none, or it can't be read.
    pub fn load(&self, name: &str) -> Result<Clip, ClipError> {
        for ending in ["json", "txt", "npy"] {
            let path = self.0.join(format!("{name}.{ending}"));
            if path.is_file() {
                return load_file(&path);
            }
        }
        Err(ClipError::Missing { clip: name.into(), folder: self.0.clone() })
    }
}

/// Reads one clip file; its ending tells the format.
///
/// # Errors
/// When it can't be read or is no clip.
pub fn load_file(path: &Path) -> Result<Clip, ClipError> {
    let io = |source| ClipError::Io { path: path.to_owned(), source };
    from_bytes(path, &read_bounded(path, MOST_BYTES).map_err(io)?)
}

/// Reads the bytes of one clip file; the ending of `path` tells the format.
///
/// # Errors
/// When they are no clip.
pub fn from_bytes(path: &Path, bytes: &[u8]) -> Result<Clip, ClipError> {
    let name = path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    let wrong = |message| ClipError::Format { clip: name.clone(), message };
    let text = || std::str::from_utf8(bytes).map_err(|_| wrong("expected UTF-8".to_owned()));
    match path.extension().and_then(|e| e.to_str()) {
        Some("json") => json::parse(&name, text()?),
        Some("txt") => deepmimic::parse(&name, text()?),
        Some("npy") => npy::parse(&name, bytes),
        other => Err(wrong(format!("expected a file ending in .json, .txt or .npy, found {other:?}"))),
    }
}
