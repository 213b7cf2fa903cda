//! Files of poses, as `trainer view --poses` writes them: generalised positions at a fixed rate. Reads and checks
//! them; the physics works out where the bodies are.

use std::fmt;
use std::path::{Path, PathBuf};

use physics_bridge::PoseError;
use serde::de::{self, DeserializeSeed, Deserializer, MapAccess, SeqAccess, Unexpected, Visitor};

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

const FIELDS: [&str; 4] = ["format", "clip", "hz", "qpos"];

/// The whole file.
struct File {
    qpos_len: usize,
}

impl<'de> DeserializeSeed<'de> for File {
    type Value = PoseClip;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<PoseClip, D::Error> {
        deserializer.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for File {
    type Value = PoseClip;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "an object with the fields format, clip, hz and qpos")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<PoseClip, A::Error> {
        let (mut format, mut clip, mut hz, mut qpos) = (None, None, None, None);
        while let Some(field) = map.next_key::<String>()? {
            let twice = match field.as_str() {
                "format" => format.replace(map.next_value_seed(Text { field: "format" })?).is_some(),
                "clip" => clip.replace(map.next_value_seed(Text { field: "clip" })?).is_some(),
                "hz" => {
                    let number = Number { field: "hz".into(), above: 0.0, most: MOST_HZ };
                    hz.replace(map.next_value_seed(number)?).is_some()
                }
                "qpos" => qpos.replace(map.next_value_seed(Rows(self.qpos_len))?).is_some(),
                other => return Err(de::Error::unknown_field(&cut(other, LONGEST_FOUND), &FIELDS)),
            };
            if twice {
                return Err(de::Error::custom(format_args!("duplicate field `{field}`")));
            }
        }
        format.ok_or_else(|| de::Error::missing_field("format"))?;
        Ok(PoseClip {
            clip: clip.ok_or_else(|| de::Error::missing_field("clip"))?,
            hz: hz.ok_or_else(|| de::Error::missing_field("hz"))?,
            qpos: qpos.ok_or_else(|| de::Error::missing_field("qpos"))?,
        })
    }
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

impl<'de> DeserializeSeed<'de> for Text {
    type Value = String;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<String, D::Error> {
        deserializer.deserialize_str(self)
    }
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

/// All poses, each of so many numbers. Each is checked as it is read, so that a bad file costs no more memory than a
/// good one.
struct Rows(usize);

impl<'de> DeserializeSeed<'de> for Rows {
    type Value = Vec<Vec<f64>>;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Self::Value, D::Error> {
        deserializer.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for Rows {
    type Value = Vec<Vec<f64>>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "qpos to be a list of 1 to {MOST_POSES} poses")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Self::Value, A::Error> {
        let mut rows = Vec::new();
        while let Some(row) =
            seq.next_element_seed(Row { index: rows.len(), length: self.0 }).map_err(|e| about("qpos", e))?
        {
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

/// The pose of an index, of so many numbers.
struct Row {
    index: usize,
    length: usize,
}

impl<'de> DeserializeSeed<'de> for Row {
    type Value = Vec<f64>;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Self::Value, D::Error> {
        deserializer.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for Row {
    type Value = Vec<f64>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "qpos[{}] to be a list of {} numbers", self.index, self.length)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Self::Value, A::Error> {
        let mut row = Vec::with_capacity(self.length);
        let mut count = 0;
        loop {
            let field = format!("qpos[{}][{count}]", self.index);
            let number = Number { field: field.clone(), above: -FURTHEST, most: FURTHEST };
            let Some(number) = seq.next_element_seed(number).map_err(|e| about(&field, e))? else { break };
            if count < self.length {
                row.push(number);
            }
            count += 1;
        }
        if count == self.length { Ok(row) } else { Err(de::Error::invalid_length(count, &self)) }
    }
}
