//! Files of poses, as `trainer view --poses` writes them: generalised positions at a fixed rate. Reads and checks
//! them; what becomes of the bodies is the physics' forward kinematics.

use std::fmt;
use std::path::{Path, PathBuf};

use physics_bridge::{PoseError, QPOS_LEN};
use serde::Deserialize;
use serde::de::{self, DeserializeSeed, Deserializer, SeqAccess, Unexpected, Visitor};

use crate::files;
use crate::text::cut;

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
pub enum PosesError {
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
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object with the fields format, clip, hz and qpos")]
pub struct Poses {
    /// [`POSES_FORMAT`].
    #[serde(deserialize_with = "format")]
    pub format: String,
    /// Name of the clip.
    #[serde(deserialize_with = "clip")]
    pub clip: String,
    /// Poses a second, above 0 and at most 1000.
    #[serde(deserialize_with = "hz")]
    pub hz: f64,
    /// One generalised position a pose, at least one; see [`QPOS_LEN`].
    #[serde(deserialize_with = "rows")]
    pub qpos: Vec<[f64; QPOS_LEN]>,
}

impl Poses {
    /// Reads a file.
    ///
    /// # Errors
    /// When it can't be read, is too large, or is no file of poses; the message names the field.
    pub fn load(path: &Path) -> Result<Self, PosesError> {
        let text = |message: String| PosesError::Text {
            path: path.to_owned(),
            message: cut(&message, LONGEST_MESSAGE),
        };
        let bytes = files::read(path, MOST_BYTES)
            .map_err(|source| PosesError::File { path: path.to_owned(), source })?;
        let poses: Self = serde_json::from_slice(&bytes).map_err(|e| text(e.to_string()))?;
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

fn format<'de, D: Deserializer<'de>>(deserializer: D) -> Result<String, D::Error> {
    deserializer.deserialize_str(Text { field: "format" })
}

fn clip<'de, D: Deserializer<'de>>(deserializer: D) -> Result<String, D::Error> {
    deserializer.deserialize_str(Text { field: "clip" })
}

fn hz<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Number { field: "hz".into(), above: 0.0, most: MOST_HZ }.deserialize(deserializer)
}

fn rows<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<[f64; QPOS_LEN]>, D::Error> {
    deserializer.deserialize_seq(Rows)
}

/// The error, with the field that it is about where the parser does not say it.
fn about<E: de::Error>(field: &str, error: E) -> E {
    let text = error.to_string();
    if text.contains(field) { error } else { E::custom(format_args!("{field}: {text}")) }
}

/// The two fields of text.
struct Text {
    field: &'static str,
}

impl Visitor<'_> for Text {
    type Value = String;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.field {
            "format" => write!(f, "format to be \"{POSES_FORMAT}\""),
            field => write!(f, "{field} to be a name of 1 to {LONGEST_NAME} printable characters"),
        }
    }

    fn visit_str<E: de::Error>(self, text: &str) -> Result<String, E> {
        let sound = match self.field {
            "format" => text == POSES_FORMAT,
            _ => (1..=LONGEST_NAME).contains(&text.chars().count()) && !text.chars().any(char::is_control),
        };
        let found = cut(text, LONGEST_FOUND);
        if sound { Ok(text.into()) } else { Err(E::invalid_value(Unexpected::Str(&found), &self)) }
    }
}

/// A number above `above` and up to `most`.
struct Number {
    field: String,
    above: f64,
    most: f64,
}

impl<'de> DeserializeSeed<'de> for Number {
    type Value = f64;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<f64, D::Error> {
        let field = self.field.clone();
        deserializer.deserialize_f64(self).map_err(|e| about(&field, e))
    }
}

impl Visitor<'_> for Number {
    type Value = f64;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} to be a number above {} and at most {}", self.field, self.above, self.most)
    }

    fn visit_f64<E: de::Error>(self, number: f64) -> Result<f64, E> {
        let sound = number > self.above && number <= self.most;
        if sound { Ok(number) } else { Err(E::invalid_value(Unexpected::Float(number), &self)) }
    }

    fn visit_i64<E: de::Error>(self, number: i64) -> Result<f64, E> {
        self.visit_f64(number as f64)
    }

    fn visit_u64<E: de::Error>(self, number: u64) -> Result<f64, E> {
        self.visit_f64(number as f64)
    }
}

/// All poses. Each is checked as it is read, so that a bad file costs no more memory than a good one.
struct Rows;

impl<'de> Visitor<'de> for Rows {
    type Value = Vec<[f64; QPOS_LEN]>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "qpos to be a list of 1 to {MOST_POSES} poses")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Self::Value, A::Error> {
        let mut rows = Vec::new();
        while let Some(row) = seq.next_element_seed(Row(rows.len())).map_err(|e| about("qpos", e))? {
            rows.push(row);
            if rows.len() > MOST_POSES {
                break;
            }
        }
        if (1..=MOST_POSES).contains(&rows.len()) {
            Ok(rows)
        } else {
            Err(de::Error::invalid_length(rows.len(), &self))
        }
    }
}

/// The pose of an index.
struct Row(usize);

impl<'de> DeserializeSeed<'de> for Row {
    type Value = [f64; QPOS_LEN];

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Self::Value, D::Error> {
        deserializer.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for Row {
    type Value = [f64; QPOS_LEN];

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "qpos[{}] to be a list of {QPOS_LEN} numbers", self.0)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Self::Value, A::Error> {
        let mut row = [0.0; QPOS_LEN];
        let mut count = 0;
        loop {
            let field = format!("qpos[{}][{count}]", self.0);
            let number = Number { field: field.clone(), above: -FURTHEST, most: FURTHEST };
            let Some(number) = seq.next_element_seed(number).map_err(|e| about(&field, e))? else { break };
            if let Some(place) = row.get_mut(count) {
                *place = number;
            }
            count += 1;
        }
        if count == QPOS_LEN { Ok(row) } else { Err(de::Error::invalid_length(count, &self)) }
    }
}
