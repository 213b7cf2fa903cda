//! Why a clip can't be used.

use std::path::PathBuf;

use files::quoted;

use crate::Leap;

/// Why a clip can't be read or fitted.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ClipError {
    /// No folder of clips was named.
    #[error(
        "expected a folder of clips by --motions or the variable {variable}, found neither; DeepMimic's data/motions, \
         the sources of pybullet (pybullet_data) and IsaacGymEnvs (assets/amp/motions) hold clips that can be read"
    )]
    NoFolder {
        /// The environment variable that may name it.
        variable: &'static str,
    },
    /// A clip of this name isn't in the folder.
    #[error("expected {clip}.json, .txt or .npy in {}, found none of them", folder.display())]
    Missing {
        /// Name of the clip.
        clip: String,
        /// Where it was looked for.
        folder: PathBuf,
    },
    /// The file can't be read.
    #[error("cannot read {}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The file is not what its ending says.
    #[error("clip {clip}: {message}")]
    Format {
        /// Name of the clip.
        clip: String,
        /// What was expected and found.
        message: String,
    },
    /// Too few or too many frames.
    #[error("clip {clip}: expected 2 to {max} frames, found {found}", max = super::MAX_FRAMES)]
    FrameCount {
        /// Name of the clip.
        clip: String,
        /// Its frames.
        found: usize,
    },
    /// Arrays of different length.
    #[error("clip {clip}: expected {expected} {field}, found {found}")]
    Lengths {
        /// Name of the clip.
        clip: String,
        /// The array.
        field: &'static str,
        /// As many as frames.
        expected: usize,
        /// Its length.
        found: usize,
    },
    /// A number is NaN, infinite or out of all bounds.
    #[error("clip {clip}: expected finite numbers within 10 km, found others in frame {frame}")]
    NotFinite {
        /// Name of the clip.
        clip: String,
        /// First such frame.
        frame: usize,
    },
    /// Times do not ascend.
    #[error("clip {clip}: expected ascending times, found frame {frame} no later than the one before")]
    Times {
        /// Name of the clip.
        clip: String,
        /// First such frame.
        frame: usize,
    },
    /// Longer than ten minutes.
    #[error("clip {clip}: expected at most 600 seconds, found {found}")]
    Duration {
        /// Name of the clip.
        clip: String,
        /// Its seconds.
        found: f32,
    },
    /// Only a cycle can be made symmetric.
    #[error("clip {clip}: expected one that loops, to be made symmetric, found one that ends")]
    NotLooping {
        /// Name of the clip.
        clip: String,
    },
    /// An excerpt that is not within the clip.
    #[error(
        "clip {clip}: expected an excerpt [from, to] with 0 <= from < to <= {duration} s, found [{}, {}]",
        found[0], found[1]
    )]
    Excerpt {
        /// Name of the clip.
        clip: String,
        /// Its seconds.
        duration: f32,
        /// First and last second that were asked for.
        found: [f32; 2],
    },
    /// A flight does not fit the clip that a leap is made of.
    #[error(
        "clip {clip}: expected a flight [from, to] with 0 < from < to < {duration} s that is to last as long or longer, and less than 2 s; found [{}, {}] and {} s",
        found.flight[0], found.flight[1], found.seconds
    )]
    Leap {
        /// Name of the clip.
        clip: String,
        /// Its seconds.
        duration: f32,
        /// What was asked for.
        found: Leap,
    },
    /// A body that has hinges is not in the clip.
    #[error("clip {clip}: expected a body {expected}, found {found}")]
    Body {
        /// Name of the clip.
        clip: String,
        /// Name of the body.
        expected: String,
        /// Bodies of the clip.
        found: String,
    },
    /// Two clips that are mixed have different bodies.
    #[error("clip {clip}: expected the bodies {expected} in this order, found {found}")]
    Bodies {
        /// Name of the clip.
        clip: String,
        /// Bodies of the other clip.
        expected: String,
        /// Its bodies.
        found: String,
    },
    /// A quaternion is not of unit length.
    #[error("clip {clip}: expected unit quaternions, found another length in frame {frame}, body {body}")]
    Quaternion {
        /// Name of the clip.
        clip: String,
        /// First such frame.
        frame: usize,
        /// Index of the body.
        body: usize,
    },
}

/// The index of the body of this name among a clip's bodies.
pub(crate) fn find_body(clip: &str, bodies: &[String], name: &str) -> Result<usize, ClipError> {
    bodies.iter().position(|body| body == name).ok_or_else(|| ClipError::Body {
        clip: clip.to_owned(),
        expected: name.to_owned(),
        found: quoted(&bodies.join(", ")),
    })
}
