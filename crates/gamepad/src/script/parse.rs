//! The RON form of a script. Every range is checked while reading, so that each error has its line.

use std::fmt;
use std::io::Read;
use std::path::Path;

use serde::Deserialize;
use serde::de::{Deserializer, Error as _, SeqAccess, Visitor};

use super::error::{Defect, ScriptError, printable};
use super::{MAX_SCRIPT_BYTES, MAX_SCRIPT_ENTRIES, MAX_SCRIPT_SECS, TAP_SECS};
use crate::Button;
use crate::files::open_regular;

pub(super) fn parse(text: &str) -> Result<ScriptFile, ScriptError> {
    if text.len() > MAX_SCRIPT_BYTES {
        return Err(ScriptError::TooLong { found: text.len() });
    }
    let options = ron::Options::default().with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME);
    let file: Checked = options.from_str(text).map_err(|error| ScriptError::Malformed {
        line: error.span.start.line,
        column: error.span.start.col,
        reason: Box::new(error.code),
        excerpt: excerpt(text, error.span.start.line),
    })?;
    Ok(file.0)
}

fn excerpt(text: &str, line: usize) -> String {
    const LONGEST: usize = 80;
    printable(text.lines().nth(line.saturating_sub(1)).unwrap_or_default().trim(), LONGEST)
}

/// Reads at most one byte over the limit, so that a huge file is not read.
pub(super) fn read_limited(path: &Path) -> Result<String, ScriptError> {
    let mut bytes = Vec::new();
    open_regular(path)?.take(MAX_SCRIPT_BYTES as u64 + 1).read_to_end(&mut bytes)?;
    if bytes.len() > MAX_SCRIPT_BYTES {
        return Err(ScriptError::TooLong { found: bytes.len() });
    }
    String::from_utf8(bytes)
        .map_err(|error| ScriptError::NotUtf8 { offset: error.utf8_error().valid_up_to() })
}

/// A file that passed all checks across entries.
#[derive(Deserialize)]
#[serde(try_from = "ScriptFile")]
struct Checked(ScriptFile);

#[derive(Deserialize)]
#[serde(rename = "Script", deny_unknown_fields)]
pub(super) struct ScriptFile {
    duration: Option<Secs>,
    pub(super) entries: Entries,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Entry {
    pub(super) at: Secs,
    #[serde(default)]
    pub(super) ramp: Secs,
    pub(super) left_stick: Option<(Axis, Axis)>,
    pub(super) right_stick: Option<(Axis, Axis)>,
    pub(super) left_trigger: Option<Pull>,
    pub(super) right_trigger: Option<Pull>,
    #[serde(default)]
    pub(super) press: ButtonList,
    #[serde(default)]
    pub(super) release: ButtonList,
    #[serde(default)]
    pub(super) tap: ButtonList,
}

impl Entry {
    fn end_secs(&self) -> f64 {
        let tap = if self.tap.0.is_empty() { 0.0 } else { TAP_SECS };
        self.at.0 + self.ramp.0.max(tap)
    }

    fn contradiction(&self) -> Option<Button> {
        let lists = [&self.press.0, &self.release.0, &self.tap.0];
        let count = |button: &Button| lists.iter().filter(|list| list.contains(button)).count();
        lists.into_iter().flatten().find(|button| count(button) > 1).copied()
    }
}

impl ScriptFile {
    fn end_secs(&self) -> f64 {
        self.entries.0.iter().map(Entry::end_secs).fold(0.0, f64::max)
    }

    pub(super) fn duration_secs(&self) -> f64 {
        self.duration.map_or_else(|| self.end_secs(), |secs| secs.0)
    }
}

impl TryFrom<ScriptFile> for Checked {
    type Error = Defect;

    fn try_from(file: ScriptFile) -> Result<Self, Defect> {
        let (end, found) = (file.end_secs(), file.duration_secs());
        if found < end { Err(Defect::Duration { end, found }) } else { Ok(Self(file)) }
    }
}

/// Entries in ascending order of time.
pub(super) struct Entries(pub(super) Vec<Entry>);

impl<'de> Deserialize<'de> for Entries {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct EntriesVisitor;
        impl<'de> Visitor<'de> for EntriesVisitor {
            type Value = Entries;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a list of entries")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Entries, A::Error> {
                let mut entries: Vec<Entry> = Vec::new();
                while let Some(entry) = seq.next_element::<Entry>()? {
                    check_next(&entries, &entry).map_err(A::Error::custom)?;
                    entries.push(entry);
                }
                Ok(Entries(entries))
            }
        }
        deserializer.deserialize_seq(EntriesVisitor)
    }
}

fn check_next(before: &[Entry], next: &Entry) -> Result<(), Defect> {
    let entry = before.len() + 1;
    if before.len() == MAX_SCRIPT_ENTRIES {
        return Err(Defect::TooManyEntries);
    }
    if let Some(previous) = before.last().map(|last| last.at.0)
        && next.at.0 <= previous
    {
        return Err(Defect::Order { entry, previous, found: next.at.0 });
    }
    match next.contradiction() {
        Some(button) => Err(Defect::Contradiction { entry, button }),
        None => Ok(()),
    }
}

/// A time or a duration in seconds.
#[derive(Clone, Copy, Default, Deserialize)]
#[serde(try_from = "f64")]
pub(super) struct Secs(pub(super) f64);

impl TryFrom<f64> for Secs {
    type Error = Defect;

    fn try_from(secs: f64) -> Result<Self, Defect> {
        if (0.0..=MAX_SCRIPT_SECS).contains(&secs) { Ok(Self(secs)) } else { Err(Defect::Time(secs)) }
    }
}

/// One axis of a stick, in [-1, 1].
#[derive(Clone, Copy, Deserialize)]
#[serde(try_from = "f32")]
pub(super) struct Axis(pub(super) f32);

impl TryFrom<f32> for Axis {
    type Error = Defect;

    fn try_from(value: f32) -> Result<Self, Defect> {
        if (-1.0..=1.0).contains(&value) { Ok(Self(value)) } else { Err(Defect::Axis(value)) }
    }
}

/// A trigger, in [0, 1].
#[derive(Clone, Copy, Deserialize)]
#[serde(try_from = "f32")]
pub(super) struct Pull(pub(super) f32);

impl TryFrom<f32> for Pull {
    type Error = Defect;

    fn try_from(value: f32) -> Result<Self, Defect> {
        if (0.0..=1.0).contains(&value) { Ok(Self(value)) } else { Err(Defect::Pull(value)) }
    }
}

/// Buttons without repetition.
#[derive(Default)]
pub(super) struct ButtonList(pub(super) Vec<Button>);

impl<'de> Deserialize<'de> for ButtonList {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ListVisitor;
        impl<'de> Visitor<'de> for ListVisitor {
            type Value = ButtonList;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a list of buttons")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<ButtonList, A::Error> {
                let mut names = Vec::new();
                while let Some(name) = seq.next_element::<Button>()? {
                    if names.contains(&name) {
                        return Err(A::Error::custom(Defect::Twice(name)));
                    }
                    names.push(name);
                }
                Ok(ButtonList(names))
            }
        }
        deserializer.deserialize_seq(ListVisitor)
    }
}
