//! Finding clips by name in a folder that the caller or the environment names.

use std::path::{Path, PathBuf};

use files::{read_bounded, read_text_bounded};

use super::{Clip, ClipError, deepmimic, json, npy};

/// Largest clip, bytes.
const MOST_BYTES: u64 = 64 << 20;

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
    let name = path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    let io = |source| ClipError::Io { path: path.to_owned(), source };
    match path.extension().and_then(|e| e.to_str()) {
        Some("json") => json::parse(&name, &read_text_bounded(path, MOST_BYTES).map_err(io)?),
        Some("txt") => deepmimic::parse(&name, &read_text_bounded(path, MOST_BYTES).map_err(io)?),
        Some("npy") => npy::parse(&name, &read_bounded(path, MOST_BYTES).map_err(io)?),
        other => Err(ClipError::Format {
            clip: name,
            message: format!("expected a file ending in .json, .txt or .npy, found {other:?}"),
        }),
    }
}
