//! The JSON of a clip. Each number is checked as it is read, so that a bad file costs no more memory than a good one.

use std::fmt;

use serde::de::{self, DeserializeSeed, Deserializer, MapAccess, SeqAccess, Unexpected, Visitor};

use super::{FURTHEST, LONGEST_FOUND, LONGEST_NAME, MOST_HZ, MOST_POSES, POSES_FORMAT, PoseClip};
use crate::text::cut;

const FIELDS: [&str; 4] = ["format", "clip", "hz", "qpos"];

/// Numbers of a pose that is too long that are counted for the message.
const MOST_COUNTED: usize = 1000;

/// The whole file.
pub(super) struct File {
    pub(super) qpos_len: usize,
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
            if count > MOST_COUNTED.max(self.length) {
                break;
            }
        }
        if count == self.length { Ok(row) } else { Err(de::Error::invalid_length(count, &self)) }
    }
}
