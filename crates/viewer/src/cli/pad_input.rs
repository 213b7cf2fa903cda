//! Pads that depend on time alone: a script, a recording of a device, or one at rest.

use std::path::Path;

use anyhow::Context as _;
use gamepad::recording::{Recording, VirtualPad};
use gamepad::{GamepadState, Script};

use super::Demo;
use crate::files;

/// A pipe that nothing is written to would be waited for without end.
fn check(path: &Path) -> anyhow::Result<()> {
    files::check_regular(path).with_context(|| path.display().to_string())
}

/// A pad that depends on time alone.
pub enum PadInput {
    /// At rest.
    Neutral,
    /// Key frames over time.
    Script(Box<Script>),
    /// Reports of a device, parsed and cleaned as those of a connected one.
    Recording(Box<VirtualPad>),
}

impl PadInput {
    /// The pad that the command line asks for.
    ///
    /// # Errors
    /// When a file can't be read or is no script or recording, or a recording's pad is not known.
    pub fn load(demo: &Demo) -> anyhow::Result<Self> {
        demo.script.iter().chain(&demo.recording).try_for_each(|path| check(path))?;
        if let Some(path) = &demo.recording {
            let pad = VirtualPad::new(Recording::load(path)?).with_context(|| path.display().to_string())?;
            return Ok(Self::Recording(Box::new(pad)));
        }
        let script = demo.script.as_deref().map(Script::load).transpose()?;
        Ok(script.map_or(Self::Neutral, |script| Self::Script(Box::new(script))))
    }

    /// The pad of a second player, where the command line asks for one.
    ///
    /// # Errors
    /// As [`PadInput::load`].
    pub fn load_second(demo: &Demo) -> anyhow::Result<Option<Self>> {
        let Some(path) = &demo.second_script else { return Ok(None) };
        check(path)?;
        Ok(Some(Self::Script(Box::new(Script::load(path)?))))
    }

    /// True for a pad that the command line asks for.
    pub fn is_given(&self) -> bool {
        !matches!(self, Self::Neutral)
    }

    /// Seconds it lasts; `None` for a pad at rest.
    pub fn duration(&self) -> Option<f64> {
        match self {
            Self::Neutral => None,
            Self::Script(script) => Some(script.duration()),
            Self::Recording(pad) => Some(pad.recording().duration()),
        }
    }

    /// The pad's state at a time, seconds; times must not go back.
    pub fn state_at(&mut self, time_secs: f64) -> GamepadState {
        match self {
            Self::Neutral => GamepadState::default(),
            Self::Script(script) => script.state_at(time_secs),
            Self::Recording(pad) => pad.report_at(time_secs).state,
        }
    }
}
