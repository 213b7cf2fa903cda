//! Scripts of pad input: sticks, triggers and buttons over time, written by hand in RON.
//!
//! Owns the meaning of a script over time. `parse` reads the text, `error` has the errors.
//! The format is described in `assets/scripts/README.md`.

mod error;
mod parse;
mod track;

use std::path::Path;

pub use error::ScriptError;
use track::{ButtonTrack, Track};

use crate::GamepadState;
use parse::{Entry, ScriptFile};

/// Largest script text accepted, in bytes.
pub const MAX_SCRIPT_BYTES: usize = 1 << 20;
/// Most entries a script may have.
pub const MAX_SCRIPT_ENTRIES: usize = 10_000;
/// Latest time a script may name, in seconds (one day).
pub const MAX_SCRIPT_SECS: f64 = 86_400.0;
/// How long a tapped button is held, in seconds: several control ticks, so that no tap is missed.
pub const TAP_SECS: f64 = 0.15;

/// A pad's input over time: analog values in straight lines between key frames, buttons by edges.
///
/// A script is immutable and has no clock: the same time gives the same state, bit for bit.
#[derive(Clone, Debug, PartialEq)]
pub struct Script {
    left_stick: [Track; 2],
    right_stick: [Track; 2],
    left_trigger: Track,
    right_trigger: Track,
    buttons: ButtonTrack,
    duration_secs: f64,
}

impl Script {
    /// Reads a script from RON text.
    ///
    /// # Errors
    /// [`ScriptError`] with line and column for invalid RON, unknown fields or buttons, times that are not
    /// ascending, negative or not finite, values out of range, and texts or counts over the limits.
    pub fn from_ron(text: &str) -> Result<Self, ScriptError> {
        parse::parse(text).map(|file| Self::from_file(&file))
    }

    /// Reads a script from a RON file.
    ///
    /// # Errors
    /// [`ScriptError::InFile`] with the file and the error.
    pub fn load(path: &Path) -> Result<Self, ScriptError> {
        let in_file = |cause| ScriptError::InFile { file: path.to_owned(), cause: Box::new(cause) };
        let text = parse::read_limited(path).map_err(in_file)?;
        Self::from_ron(&text).map_err(in_file)
    }

    /// The pad's state at `time_secs` after the start. The first state applies before zero (and for NaN), the last
    /// one after the end. Does not allocate.
    #[must_use]
    pub fn state_at(&self, time_secs: f64) -> GamepadState {
        let time_secs = time_secs.max(0.0);
        let stick = |tracks: &[Track; 2]| [tracks[0].value_at(time_secs), tracks[1].value_at(time_secs)];
        GamepadState {
            left_stick: stick(&self.left_stick),
            right_stick: stick(&self.right_stick),
            left_trigger: self.left_trigger.value_at(time_secs),
            right_trigger: self.right_trigger.value_at(time_secs),
            buttons: self.buttons.value_at(time_secs),
        }
    }

    /// Length in seconds: the `duration` of the script, or the end of its last ramp or tap.
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.duration_secs
    }

    fn from_file(file: &ScriptFile) -> Self {
        let mut script = Self {
            left_stick: Default::default(),
            right_stick: Default::default(),
            left_trigger: Track::default(),
            right_trigger: Track::default(),
            buttons: ButtonTrack::default(),
            duration_secs: file.duration_secs(),
        };
        for entry in &file.entries.0 {
            script.apply(entry);
        }
        script.buttons.finish();
        script
    }

    fn apply(&mut self, entry: &Entry) {
        let (at, ramp) = (entry.at.0, entry.ramp.0);
        for (tracks, stick) in
            [(&mut self.left_stick, entry.left_stick), (&mut self.right_stick, entry.right_stick)]
        {
            if let Some((x, y)) = stick {
                tracks[0].push(at, ramp, x.0);
                tracks[1].push(at, ramp, y.0);
            }
        }
        for (track, trigger) in
            [(&mut self.left_trigger, entry.left_trigger), (&mut self.right_trigger, entry.right_trigger)]
        {
            if let Some(pull) = trigger {
                track.push(at, ramp, pull.0);
            }
        }
        for &name in &entry.press.0 {
            self.buttons.push(at, name, true);
        }
        for &name in &entry.release.0 {
            self.buttons.push(at, name, false);
        }
        for &name in &entry.tap.0 {
            self.buttons.push_tap(at, at + TAP_SECS, name);
        }
    }
}
