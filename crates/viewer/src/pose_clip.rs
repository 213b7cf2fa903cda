//! Files of poses, as `trainer view --poses` writes them: generalised positions at a fixed rate. Reads and checks
//! them; the physics works out where the bodies are.

mod parse;

use std::path::{Path, PathBuf};

use physics_bridge::PoseError;
use serde::de::DeserializeSeed as _;

use crate::files;
use crate::text::cut;
use parse::File;

/// First field of every such file.
pub const POSES_FORMAT: &str = "policy-space poses";
/// Largest file that is read, bytes.
const MOST_BYTES: u64 = 64 << 20;
/// Most poses, and the longest time that they may last, seconds.
const MOST_POSES: usize = 100_000;
const MOST_SECS: f64 = 3600.0;
/// Most poses a second.
const MOST_HZ: f64 = 1000.0;
/// No position or angle is further from zero, metres or radians.
const FURTHEST: f64 = 1e4;
/// Longest name of a clip, longest text of a file in a message, and longest message, characters.
const LONGEST_NAME: usize = 200;
const LONGEST_FOUND: usize = 60;
const LONGEST_MESSAGE: usize = 300;

/// Why a file of poses can't be played.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PoseClipError {
    /// The file can't be read, or is too large.
    #[error("poses {}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        source: files::ReadError,
    },
    /// The text is no file of poses.
    #[error("poses {}: {message}", path.display())]
    Text {
        /// The file.
        path: PathBuf,
        /// The field, what was expected, what was found, and where.
        message: String,
    },
    /// A pose that no character can take.
    #[error("poses {}: qpos[{row}]: {source}", path.display())]
    Pose {
        /// The file.
        path: PathBuf,
        /// Index of the pose.
        row: usize,
        /// What is wrong with it; its `qpos` is this pose.
        source: PoseError,
    },
}

/// A clip as poses.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseClip {
    /// Name of the clip.
    pub clip: String,
    /// Poses a second, above 0 and at most 1000.
    pub hz: f64,
    /// One generalised position a pose, at least one: position (3) and rotation (4, wxyz) of the root, then the
    /// hinges, metres and radians.
    pub qpos: Vec<Vec<f64>>,
}

impl PoseClip {
    /// Reads a file whose poses have `qpos_len` numbers each.
    ///
    /// # Errors
    /// When it can't be read, is too large, or is no file of such poses; the message names the field.
    pub fn load(path: &Path, qpos_len: usize) -> Result<Self, PoseClipError> {
        let text = |message: String| PoseClipError::Text {
            path: path.to_owned(),
            message: cut(&message, LONGEST_MESSAGE),
        };
        let bytes = files::read(path, MOST_BYTES)
            .map_err(|source| PoseClipError::File { path: path.to_owned(), source })?;
        let mut json = serde_json::Deserializer::from_slice(&bytes);
        let poses = File { qpos_len }
            .deserialize(&mut json)
            .and_then(|poses| json.end().map(|()| poses))
            .map_err(|e| text(e.to_string()))?;
        let seconds = poses.qpos.len() as f64 / poses.hz;
        if seconds > MOST_SECS {
            return Err(text(format!(
                "hz and qpos: expected at most {MOST_SECS} seconds, found {} poses at {} Hz, {seconds:.0} seconds",
                poses.qpos.len(),
                poses.hz,
            )));
        }
        Ok(poses)
    }
}
