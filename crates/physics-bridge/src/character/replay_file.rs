//! A character in a file: everything needed to continue from the state in it, bit for bit, on the same build
//! of MuJoCo. Refuses a file in which anything is missing, left over or not finite.

mod error;

use std::path::Path;
use std::sync::Arc;

use mujoco_rs::wrappers::mj_data::MjtState;
use policy_core::contract::Settings;
use policy_core::format::{RolesEntry, SkeletonEntry};
use policy_core::training::{Roles, SkeletonBody, SkeletonJoint};
use policy_core::{BodyId, Skeleton};
use serde::{Deserialize, Serialize};

use super::push::Pushes;
use super::{Character, Snapshot};
use crate::description::file::{self, quoted};
use crate::description::model::{Model, STATE, Source};
use crate::description::terrain::Terrain;

pub use self::error::ReplayFileError;

/// What the files say they are.
const FORMAT: &str = "policy-space replay";

/// The version that is written, and the only one that is read.
const VERSION: u32 = 2;

/// Longest file, bytes: an MJCF of the longest, and a state.
const MOST_BYTES: usize = 16 << 20;

/// MuJoCo resets a simulation in which a number is larger.
const LARGEST: f64 = 1e10;

/// Control rates that a file may ask for, ticks per second.
const CONTROL_HZ: std::ops::RangeInclusive<f32> = 1.0..=1000.0;

/// A saved character with its model.
#[derive(Clone, Debug, PartialEq)]
pub struct ReplayFile {
    mjcf: Arc<str>,
    skeleton: Arc<Skeleton>,
    control_hz: f32,
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
    skeleton: SkeletonEntry,
    control_hz: f32,
    terrain: Terrain,
    settings: Settings,
    tick: u64,
    pushes: Pushes,
    state: String,
}

impl ReplayFile {
    pub(super) fn new(model: &Model, snapshot: Snapshot) -> Self {
        let Source { mjcf, control_hz, terrain, .. } = model.source().clone();
        let (skeleton, settings) = (Arc::clone(model.skeleton()), model.settings());
        Self { mjcf, skeleton, control_hz, terrain, settings, snapshot }
    }

    /// The state.
    #[must_use]
    pub fn snapshot(&self) -> &Snapshot {
        &self.snapshot
    }

    /// Bodies and hinges of the character.
    #[must_use]
    pub fn skeleton(&self) -> &Arc<Skeleton> {
        &self.skeleton
    }

    /// The character in the state, on the ground and with the settings that it had. After a
    /// [`Diverged`](crate::Diverged), one [`Character::step`] of it diverges in the same way.
    ///
    /// # Errors
    /// When the parts of a file do not fit together.
    pub fn to_character(&self) -> Result<Character, ReplayFileError> {
        let source = Source {
            mjcf: Arc::clone(&self.mjcf),
            skeleton: Some(Arc::clone(&self.skeleton)),
            control_hz: self.control_hz,
            terrain: self.terrain,
        };
        let model = Model::compile(source)
            .and_then(|model| model.with_settings(self.settings))
            .map_err(|error| ReplayFileError::Model { error })?;
        self.check_numbers(&model)?;
        let mut character = Character::new(&model);
        character.restore(&self.snapshot).map_err(|error| ReplayFileError::Snapshot { error })?;
        Ok(character)
    }

    /// Writes the JSON.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let file = File {
            format: FORMAT.into(),
            version: VERSION,
            mjcf: (*self.mjcf).into(),
            skeleton: SkeletonEntry::from(&*self.skeleton),
            control_hz: self.control_hz,
            terrain: self.terrain,
            settings: self.settings,
            tick: self.snapshot.tick,
            pushes: self.snapshot.pushes.clone(),
            state: self.snapshot.state.iter().map(|v| format!("{:016x}", v.to_bits())).collect(),
        };
        serde_json::to_vec_pretty(&file).expect("finite numbers, texts and lists are JSON")
    }

    /// Reads the JSON.
    ///
    /// # Errors
    /// When it is not the JSON of a replay file of this version, or a number in it is out of its range.
    /// [`ReplayFile::to_character`] finds out whether the model compiles.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, ReplayFileError> {
        let file: File = serde_json::from_slice(bytes)
            .map_err(|error| ReplayFileError::Json { message: quoted(&error.to_string()) })?;
        if file.format != FORMAT || file.version != VERSION {
            return Err(ReplayFileError::Format { format: quoted(&file.format), version: file.version });
        }
        if !CONTROL_HZ.contains(&file.control_hz) {
            return Err(ReplayFileError::ControlRate { found: file.control_hz });
        }
        let skeleton = Arc::new(skeleton(file.skeleton)?);
        if !file.pushes.fit(skeleton.body_count()) || !file.pushes.are_sound() {
            return Err(ReplayFileError::Pushes);
        }
        let state = parse_state(&file.state)?;
        let snapshot = Snapshot { state, tick: file.tick, pushes: file.pushes };
        let File { mjcf, control_hz, terrain, settings, .. } = file;
        Ok(Self { mjcf: mjcf.into(), skeleton, control_hz, terrain, settings, snapshot })
    }

    /// Writes a file, whole or not at all: after an error the file is as it was.
    ///
    /// # Errors
    /// When the system refuses.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), ReplayFileError> {
        let path = path.as_ref();
        file::write_whole(path, &self.to_bytes())
            .map_err(|source| ReplayFileError::Access { path: path.to_owned(), source })
    }

    /// Reads a file.
    ///
    /// # Errors
    /// When the system refuses, and as [`ReplayFile::from_bytes`].
    pub fn load(path: impl AsRef<Path>) -> Result<Self, ReplayFileError> {
        let path = path.as_ref();
        let bytes = file::read(path, MOST_BYTES)
            .map_err(|source| ReplayFileError::Access { path: path.to_owned(), source })?;
        Self::from_bytes(&bytes)
    }

    /// Everything but the joint targets must be a number that MuJoCo accepts.
    fn check_numbers(&self, model: &Model) -> Result<(), ReplayFileError> {
        let ctrl = MjtState::mjSTATE_CTRL as u32;
        let first = model.physics().state_size(STATE & (ctrl - 1));
        let targets = first..first + model.physics().state_size(ctrl);
        let bad = |(index, v): &(usize, &f64)| !targets.contains(index) && (v.is_nan() || v.abs() >= LARGEST);
        match self.snapshot.state.iter().enumerate().find(bad) {
            Some((index, &found)) => Err(ReplayFileError::Number { index, found }),
            None => Ok(()),
        }
    }
}

/// The skeleton of its names.
fn skeleton(entry: SkeletonEntry) -> Result<Skeleton, ReplayFileError> {
    let names: Vec<String> = entry.bodies.iter().map(|body| body.name.clone()).collect();
    let body = |name: String| match names.iter().position(|n| *n == name) {
        Some(index) => Ok(BodyId::new(index)),
        None => Err(ReplayFileError::Body { found: quoted(&name) }),
    };
    let bodies = entry.bodies.into_iter().map(|b| {
        let parent = b.parent.map(body).transpose()?;
        Ok(SkeletonBody { name: b.name, parent })
    });
    let joints = entry.joints.into_iter().map(|j| {
        let body = body(j.body)?;
        Ok(SkeletonJoint { name: j.name, body, axis: j.axis.into(), range: j.range })
    });
    let (bodies, joints) = (bodies.collect::<Result<_, _>>()?, joints.collect::<Result<_, _>>()?);
    let all = |names: Vec<String>| names.into_iter().map(body).collect::<Result<_, _>>();
    let RolesEntry { head, hands, feet } = entry.roles;
    let roles = Roles { head: head.map(body).transpose()?, hands: all(hands)?, feet: all(feet)? };
    Skeleton::from_parts(bodies, joints, roles).map_err(|error| ReplayFileError::Skeleton { error })
}

fn parse_state(digits: &str) -> Result<Box<[f64]>, ReplayFileError> {
    const DIGITS: usize = 16;
    let number = |(index, chunk): (usize, &[u8])| {
        let bits = std::str::from_utf8(chunk).ok().filter(|c| c.len() == DIGITS && !c.starts_with('+'));
        let bits = bits.and_then(|c| u64::from_str_radix(c, 16).ok());
        bits.map(f64::from_bits).ok_or(ReplayFileError::State { offset: index * DIGITS })
    };
    digits.as_bytes().chunks(DIGITS).enumerate().map(number).collect()
}

impl Character {
    /// The character as it is now, for a file.
    #[must_use]
    pub fn replay_file(&self) -> ReplayFile {
        ReplayFile::new(&self.model, self.save())
    }
}
