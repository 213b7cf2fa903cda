//! A character in a file: everything needed to run on from the state in it, bit for bit, on the same build
//! of MuJoCo. Refuses a file in which anything is missing, left over or not finite.

use std::path::{Path, PathBuf};

use mujoco_rs::wrappers::mj_data::MjtState;
use serde::{Deserialize, Serialize};

use crate::character::Character;
use crate::model::{Model, STATE};
use crate::model_error::ModelError;
use crate::push::Pushes;
use crate::settings::Settings;
use crate::snapshot::{Snapshot, SnapshotMismatch};
use crate::terrain::Terrain;

/// What the files say they are.
const FORMAT: &str = "policy-space physics dump";

/// The version that is written, and the only one that is read.
const VERSION: u32 = 1;

/// MuJoCo resets a simulation in which a number is larger.
const LARGEST: f64 = 1e10;

/// A saved character with its model.
#[derive(Clone, Debug, PartialEq)]
pub struct Dump {
    mjcf: Box<str>,
    terrain: Terrain,
    settings: Settings,
    snapshot: Snapshot,
}

/// The JSON. Numbers of the state are the bits of doubles in hexadecimal, one after the other, because a
/// joint target that is not a number is a thing to be replayed.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    format: String,
    version: u32,
    mjcf: Box<str>,
    terrain: Terrain,
    settings: Settings,
    tick: u64,
    pushes: Pushes,
    state: String,
}

/// Why a dump can't be read, written or run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DumpError {
    /// The file can't be read or written.
    #[error("cannot access the dump {}", path.display())]
    Access {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The bytes are not the JSON of a dump.
    #[error("expected the JSON of a physics dump: {source}")]
    Json {
        /// What is wrong, with line and column.
        source: serde_json::Error,
    },
    /// Something else, or from another version.
    #[error("expected {FORMAT:?} of version {VERSION}, found {format:?} of version {version}")]
    Format {
        /// What the file says it is.
        format: String,
        /// Its version.
        version: u32,
    },
    /// The state is not hexadecimal doubles.
    #[error("expected 16 hexadecimal digits at character {offset} of state, found something else")]
    State {
        /// Where, in characters.
        offset: usize,
    },
    /// A number of the state can't be simulated.
    #[error("expected a finite number below {LARGEST:e} in size as number {index} of state, found {found}")]
    Number {
        /// Which, from 0.
        index: usize,
        /// The number.
        found: f64,
    },
    /// A push can't be simulated.
    #[error("expected finite forces of at most 1 MN in pushes, found others")]
    Pushes,
    /// The model can't be compiled.
    #[error("in the dump's model: {source}")]
    Model {
        /// Why.
        source: ModelError,
    },
    /// The state does not belong to the model.
    #[error("in the dump's state: {source}")]
    Snapshot {
        /// Why.
        source: SnapshotMismatch,
    },
}

impl Dump {
    pub(crate) fn new(model: &Model, snapshot: Snapshot) -> Self {
        Self { mjcf: model.mjcf().into(), terrain: model.terrain(), settings: model.settings(), snapshot }
    }

    /// The state.
    #[must_use]
    pub fn snapshot(&self) -> &Snapshot {
        &self.snapshot
    }

    /// The character in the state, on the ground and with the settings that it had. After a
    /// [`Diverged`](crate::Diverged), one [`Character::step`] of it diverges in the same way.
    ///
    /// # Errors
    /// When the parts of a dump that was read from a file don't fit together.
    pub fn to_character(&self) -> Result<Character, DumpError> {
        let model = Model::compile(&self.mjcf, self.terrain)
            .and_then(|model| model.with_settings(self.settings))
            .map_err(|source| DumpError::Model { source })?;
        self.check_numbers(&model)?;
        let mut character = Character::new(&model);
        character.restore(&self.snapshot).map_err(|source| DumpError::Snapshot { source })?;
        Ok(character)
    }

    /// Writes the JSON.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let file = File {
            format: FORMAT.into(),
            version: VERSION,
            mjcf: self.mjcf.clone(),
            terrain: self.terrain,
            settings: self.settings,
            tick: self.snapshot.tick,
            pushes: self.snapshot.pushes,
            state: self.snapshot.state.iter().map(|v| format!("{:016x}", v.to_bits())).collect(),
        };
        serde_json::to_vec_pretty(&file).expect("finite numbers, texts and lists are JSON")
    }

    /// Reads the JSON.
    ///
    /// # Errors
    /// When it is not the JSON of a dump of this version, or a number in it is out of its range. Whether the
    /// model compiles is found out by [`Dump::to_character`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, DumpError> {
        let file: File = serde_json::from_slice(bytes).map_err(|source| DumpError::Json { source })?;
        if file.format != FORMAT || file.version != VERSION {
            return Err(DumpError::Format { format: file.format, version: file.version });
        }
        if !file.pushes.are_sound() {
            return Err(DumpError::Pushes);
        }
        let state = parse_state(&file.state)?;
        let snapshot = Snapshot { state, tick: file.tick, pushes: file.pushes };
        Ok(Self { mjcf: file.mjcf, terrain: file.terrain, settings: file.settings, snapshot })
    }

    /// Writes a file.
    ///
    /// # Errors
    /// When the system refuses.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), DumpError> {
        let path = path.as_ref();
        std::fs::write(path, self.to_bytes())
            .map_err(|source| DumpError::Access { path: path.to_owned(), source })
    }

    /// Reads a file.
    ///
    /// # Errors
    /// When the system refuses, and as [`Dump::from_bytes`].
    pub fn load(path: impl AsRef<Path>) -> Result<Self, DumpError> {
        let path = path.as_ref();
        let bytes =
            std::fs::read(path).map_err(|source| DumpError::Access { path: path.to_owned(), source })?;
        Self::from_bytes(&bytes)
    }

    /// Everything but the joint targets must be a number that MuJoCo accepts.
    fn check_numbers(&self, model: &Model) -> Result<(), DumpError> {
        let ctrl = MjtState::mjSTATE_CTRL as u32;
        let first = model.physics().state_size(STATE & (ctrl - 1));
        let targets = first..first + model.physics().state_size(ctrl);
        let bad = |(index, v): &(usize, &f64)| !targets.contains(index) && (v.is_nan() || v.abs() >= LARGEST);
        match self.snapshot.state.iter().enumerate().find(bad) {
            Some((index, &found)) => Err(DumpError::Number { index, found }),
            None => Ok(()),
        }
    }
}

fn parse_state(digits: &str) -> Result<Box<[f64]>, DumpError> {
    const DIGITS: usize = 16;
    let number = |(index, chunk): (usize, &[u8])| {
        let bits = std::str::from_utf8(chunk).ok().filter(|c| c.len() == DIGITS && !c.starts_with('+'));
        let bits = bits.and_then(|c| u64::from_str_radix(c, 16).ok());
        bits.map(f64::from_bits).ok_or(DumpError::State { offset: index * DIGITS })
    };
    digits.as_bytes().chunks(DIGITS).enumerate().map(number).collect()
}

impl Character {
    /// The character as it is now, for a file.
    #[must_use]
    pub fn dump(&self) -> Dump {
        Dump::new(&self.model, self.save())
    }
}
