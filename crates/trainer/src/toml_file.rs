//! TOML files: read up to a size, and parsed with errors that name the file.

use std::path::{Path, PathBuf};

use files::{quoted, read_text_bounded};
use serde::de::DeserializeOwned;

/// Largest file, bytes.
const MOST_BYTES: u64 = 1 << 20;

/// Why a TOML file can't be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TomlFileError {
    /// The file can't be opened, is no UTF-8, or is larger than 1 MiB.
    #[error("cannot read {}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// It is no TOML, or its fields are not those expected.
    #[error("{}: {message}", path.display())]
    Toml {
        /// The file.
        path: PathBuf,
        /// What was expected and found, with its line.
        message: String,
    },
}

impl TomlFileError {
    pub(crate) fn toml(path: &Path, message: String) -> Self {
        Self::Toml { path: path.to_owned(), message }
    }
}

/// The text of a file of at most 1 MiB.
pub(crate) fn read_text(path: &Path) -> Result<String, TomlFileError> {
    read_text_bounded(path, MOST_BYTES).map_err(|source| TomlFileError::Io { path: path.to_owned(), source })
}

/// Parses a text; `path` is only named in errors.
pub(crate) fn parse<T: DeserializeOwned>(path: &Path, text: &str) -> Result<T, TomlFileError> {
    toml::from_str(text).map_err(|e| TomlFileError::toml(path, quoted(&e.to_string())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, serde::Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Speeds {
        #[expect(dead_code, reason = "parsed and not read")]
        walk: f32,
    }

    #[test]
    fn errors_name_the_file_and_the_field() {
        let path = Path::new("speeds.toml");
        assert!(parse::<Speeds>(path, "walk = 1.0").is_ok());
        for (text, field) in [("walk = 1.0\nrun = 3.0", "run"), ("", "walk"), ("walk = \"fast\"", "walk")] {
            let error = parse::<Speeds>(path, text).unwrap_err().to_string();
            assert!(error.starts_with("speeds.toml: ") && error.contains(field), "{error}");
        }
    }

    #[test]
    fn a_missing_file_and_one_that_is_no_text_are_told() {
        let missing = read_text(Path::new("no_such_file.toml")).unwrap_err();
        assert_eq!(missing.to_string(), "cannot read no_such_file.toml");
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("bytes.toml");
        std::fs::write(&path, [0xff, 0xfe]).unwrap();
        let error = read_text(&path).unwrap_err();
        let source = std::error::Error::source(&error).unwrap();
        assert!(source.to_string().contains("UTF-8"), "{source}");
    }
}
