//! Why bytes or a text are no replay.

/// Why a replay can't be made, read or played.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ReplayError {
    /// Too many bytes.
    #[error("expected a replay of at most {most} bytes, found {found}")]
    TooLong {
        /// Most bytes.
        most: usize,
        /// Bytes found.
        found: usize,
    },
    /// It ends too early.
    #[error("in {field} of a replay: expected {expected} more bytes, found {found}")]
    Ends {
        /// Where.
        field: &'static str,
        /// Bytes that are needed.
        expected: usize,
        /// Bytes that are left.
        found: usize,
    },
    /// It goes on behind its end.
    #[error("expected the end of a replay, found {found} more bytes")]
    Trailing {
        /// Bytes behind the end.
        found: usize,
    },
    /// Not a replay at all.
    #[error("expected a replay, which begins with the bytes {expected:02x?}, found {found:02x?}")]
    Magic {
        /// First bytes of a replay.
        expected: [u8; 4],
        /// First bytes found.
        found: [u8; 4],
    },
    /// Another version of the format.
    #[error("expected a replay of format version {expected}, found {found}")]
    Version {
        /// The version that this library reads.
        expected: u16,
        /// The version found.
        found: u16,
    },
    /// Bytes were changed.
    #[error("expected the checksum {expected:08x} of a replay's bytes, found {found:08x}: it is damaged")]
    Checksum {
        /// Of the bytes.
        expected: u32,
        /// In the replay.
        found: u32,
    },
    /// A field is out of its range.
    #[error("in {field} of a replay: expected {expected}, found {found}")]
    Field {
        /// The field.
        field: &'static str,
        /// What it may be.
        expected: &'static str,
        /// What it is.
        found: String,
    },
    /// The replay is of something else.
    #[error("expected a replay of the {field} {expected}, found one of {found}")]
    Other {
        /// `pack`, `scene`, `seed` or `players`.
        field: &'static str,
        /// What is simulated here.
        expected: String,
        /// What the replay was recorded with.
        found: String,
    },
    /// A link is too long.
    #[error("expected a link of at most {most} characters, found {found}: a replay this long needs a file")]
    LongLink {
        /// Most characters.
        most: usize,
        /// Characters found.
        found: usize,
    },
    /// A link has a character that base64url has not.
    #[error("at character {at} of a link: expected one of A-Z, a-z, 0-9, `-` and `_`, found {found:?}")]
    Character {
        /// Its index, from 0.
        at: usize,
        /// The character.
        found: char,
    },
    /// A link is cut off in the middle of a byte.
    #[error("expected a link of whole bytes, found {found} characters, whose last bits are left over")]
    LinkEnd {
        /// Characters found.
        found: usize,
    },
}
