//! Errors of recordings.

use std::path::PathBuf;

use super::{MAX_RECORDED_REPORT, MAX_RECORDING_BYTES, MAX_RECORDING_MICROS, VERSION};

/// Why a recording was refused.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// The first bytes are not those of a recording.
    #[error("expected a pad recording, found another kind of file")]
    NoRecording,
    /// A version that this build does not know.
    #[error("format version: expected {VERSION}, found {found}")]
    Version {
        /// Version found.
        found: u16,
    },
    /// The recording is too long.
    #[error("expected at most {MAX_RECORDING_BYTES} bytes, found {found}")]
    TooLong {
        /// Bytes found; for a file at least this many.
        found: usize,
    },
    /// The file ends inside the header or an event.
    #[error("byte {offset}: expected {expected} more bytes, found {found}")]
    Truncated {
        /// Offset of the missing bytes.
        offset: usize,
        /// Bytes expected there.
        expected: usize,
        /// Bytes found there.
        found: usize,
    },
    /// The checksum of the header or of an event does not match.
    #[error(
        "byte {offset}: expected the checksum of the header or event that starts here, found another one"
    )]
    Checksum {
        /// Where the header or event starts.
        offset: usize,
    },
    /// A field of the header has an unknown value.
    #[error("header field `{name}`: expected a known value, found {found}")]
    Field {
        /// Name of the field.
        name: &'static str,
        /// Value found.
        found: u32,
    },
    /// The name is not UTF-8.
    #[error("header field `name`: expected UTF-8 text, found other bytes")]
    Name,
    /// An event has an unknown kind or invalid data.
    #[error(
        "event at byte {offset}: expected a known kind with its data (a report of at most {MAX_RECORDED_REPORT} \
         bytes, or a state), found kind {kind} with {len} bytes"
    )]
    Event {
        /// Where the event starts.
        offset: usize,
        /// Kind found.
        kind: u8,
        /// Length found.
        len: usize,
    },
    /// A time is before the previous one or past the limit.
    #[error(
        "event at byte {offset}: expected a time from {previous} to {MAX_RECORDING_MICROS} us, found {found} us"
    )]
    Time {
        /// Where the event starts.
        offset: usize,
        /// Time of the event before, in microseconds.
        previous: u64,
        /// Time found, in microseconds.
        found: u64,
    },
    /// The file can't be read or written.
    #[error("cannot be read or written: {0}")]
    Io(std::io::Error),
    /// Any other error, with the file.
    #[error("{}: {cause}", file.display())]
    InFile {
        /// The recording's file.
        file: PathBuf,
        /// The error.
        cause: Box<RecordingError>,
    },
}

impl From<std::io::Error> for RecordingError {
    fn from(error: std::io::Error) -> Self {
        Self::Io(error)
    }
}
