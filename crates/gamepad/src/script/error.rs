//! Errors of scripts.

use std::path::PathBuf;

use super::{MAX_SCRIPT_BYTES, MAX_SCRIPT_ENTRIES, MAX_SCRIPT_SECS};

/// Most characters of a reason that are shown: it may quote the file.
const MAX_REASON: usize = 200;

/// Why a script was refused.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ScriptError {
    /// The text is not a script: invalid RON, an unknown field or button, or a value out of its range.
    #[error("line {line}, column {column}: {} (in `{excerpt}`)", printable(&reason.to_string(), MAX_REASON))]
    Malformed {
        /// Line at which reading stopped, from 1.
        line: usize,
        /// Column at which reading stopped, from 1.
        column: usize,
        /// What was expected and found.
        reason: Box<ron::error::Error>,
        /// That line, cut short, without control characters.
        excerpt: String,
    },
    /// The text is too long.
    #[error("expected at most {MAX_SCRIPT_BYTES} bytes, found {found}")]
    TooLong {
        /// Length found, in bytes; for a file at least this many.
        found: usize,
    },
    /// The file is not UTF-8.
    #[error("expected UTF-8 text, found another byte at offset {offset}")]
    NotUtf8 {
        /// First byte that is not UTF-8.
        offset: usize,
    },
    /// The file can't be read.
    #[error("cannot be read: {0}")]
    Unreadable(std::io::Error),
    /// Any other error, with the file.
    #[error("{}: {cause}", file.display())]
    InFile {
        /// The script's file.
        file: PathBuf,
        /// The error.
        cause: Box<ScriptError>,
    },
}

impl From<std::io::Error> for ScriptError {
    fn from(error: std::io::Error) -> Self {
        Self::Unreadable(error)
    }
}

/// The first `most` characters of text from a file, with control characters replaced, so that it can't control a terminal.
pub(super) fn printable(text: &str, most: usize) -> String {
    let shown = |c: char| if c.is_control() { char::REPLACEMENT_CHARACTER } else { c };
    text.chars().map(shown).take(most).collect()
}

/// A value that is valid in RON but not in a script; shown inside [`ScriptError::Malformed`].
#[derive(Debug, thiserror::Error)]
pub(super) enum Defect {
    #[error("time: expected seconds in [0, {MAX_SCRIPT_SECS}], found {0}")]
    Time(f64),
    #[error("stick: expected each axis in [-1, 1], found {0}")]
    Axis(f32),
    #[error("trigger: expected a pull in [0, 1], found {0}")]
    Pull(f32),
    #[error(
        "entry {entry}: `at`: expected a time after {previous} (entries are in order of time), found {found}"
    )]
    Order { entry: usize, previous: f64, found: f64 },
    #[error("`entries`: expected at most {MAX_SCRIPT_ENTRIES} entries, found more")]
    TooManyEntries,
    #[error("buttons: expected each button at most once in a list, found `{0:?}` again")]
    Twice(crate::Button),
    #[error(
        "entry {entry}: `{button:?}`: expected it in one of `press`, `release` and `tap`, found it in two"
    )]
    Contradiction { entry: usize, button: crate::Button },
    #[error("`duration`: expected at least {end}, the end of the last ramp or tap, found {found}")]
    Duration { end: f64, found: f64 },
}
