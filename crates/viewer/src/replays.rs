//! Records what the player presses, or plays it again and compares states. Knows the scenes of the demo, no files.
//!
//! What panels and the mouse change is not recorded: the demo refuses it meanwhile.

use policy_core::{BlendMode, GamepadState, Heading};
use replay::{Header, Mismatch, Pad, Playback, Recorder, Replay, ReplayError};

use crate::sim::{Engine, GroundKind, MAX_CHARACTERS, SceneKind, SimConfig, Simulation};

/// What becomes of the pad of a tick.
#[derive(Debug, Default)]
pub enum Replaying {
    /// It steers.
    #[default]
    Off,
    /// It steers in whole numbers, and is kept.
    Recording(Box<Recorder>),
    /// That of the replay steers.
    Playing(Box<Playback>),
}

impl Replaying {
    /// True while nothing is recorded or played.
    #[must_use]
    pub fn is_off(&self) -> bool {
        matches!(self, Self::Off)
    }

    /// Pad and camera of the next tick in place of those of the player; `None` when a replay has come to its end.
    pub fn steer(&mut self, pad: &GamepadState, camera: Heading) -> Option<(GamepadState, Heading)> {
        match self {
            Self::Off => Some((*pad, camera)),
            Self::Recording(_) => {
                let pad = Pad::from_state(pad, camera);
                Some((pad.state(), pad.heading()))
            }
            Self::Playing(playback) => {
                let pad = *playback.next_pads()?.first()?;
                Some((pad.state(), pad.heading()))
            }
        }
    }

    /// After a tick under that pad and camera: keeps them, or compares the state.
    ///
    /// # Errors
    /// When the state is not the recorded one, or the recording is as long as it may be. Both end here.
    pub fn follow(&mut self, pad: &GamepadState, camera: Heading, hash: u64) -> Result<(), ReplayingError> {
        match self {
            Self::Off => Ok(()),
            Self::Recording(recorder) => Ok(recorder.push(&[Pad::from_state(pad, camera)], hash)?),
            Self::Playing(playback) => Ok(playback.check(hash)?),
        }
    }

    /// The recording so far.
    #[must_use]
    pub fn recorded(&self) -> Option<&Replay> {
        match self {
            Self::Recording(recorder) => Some(recorder.replay()),
            _ => None,
        }
    }
}

/// Why recording or playing ended before its time.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ReplayingError {
    /// The state differs.
    #[error(transparent)]
    Mismatch(#[from] Mismatch),
    /// The recording is full.
    #[error(transparent)]
    Replay(#[from] ReplayError),
}

/// What a replay says of the world that it was recorded in: `scene/engine/ground/characters/mode`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Setting {
    /// What stands on the floor.
    pub scene: SceneKind,
    /// The physics.
    pub engine: Engine,
    /// The ground.
    pub ground: GroundKind,
    /// Characters.
    pub characters: usize,
    /// How a blend becomes an action.
    pub mode: BlendMode,
}

impl Setting {
    /// That of a world.
    #[must_use]
    pub fn of(sim: &Simulation) -> Self {
        let SimConfig { scene, engine, ground, characters, .. } = *sim.config();
        Self { scene, engine, ground, characters, mode: sim.blend_mode() }
    }

    /// Reads the scene of a replay's header.
    ///
    /// # Errors
    /// When it is none of the demo's.
    pub fn from_header(header: &Header) -> Result<Self, ReplayError> {
        let known = || {
            let mut words = header.scene.split('/');
            let setting = Self {
                scene: SceneKind::from_name(words.next()?)?,
                engine: Engine::from_name(words.next()?)?,
                ground: GroundKind::from_name(words.next()?)?,
                characters: words.next()?.parse().ok().filter(|n| (1..=MAX_CHARACTERS).contains(n))?,
                mode: BlendMode::from_name(words.next()?)?,
            };
            words.next().is_none().then_some(setting)
        };
        known().filter(|_| header.players == 1).ok_or_else(|| ReplayError::Field {
            field: "scene",
            expected: "a scene of the demo for one player, such as empty/rapier/flat/1/parameters",
            found: format!("{:?} for {}", header.scene, header.players),
        })
    }

    /// The header of a replay that begins now.
    #[must_use]
    pub fn header(&self, sim: &Simulation, pack_hash: u64) -> Header {
        let Self { scene, engine, ground, characters, mode } = self;
        let words = [scene.name(), engine.name(), ground.name(), &characters.to_string(), mode.name()];
        Header {
            pack_hash,
            seed: sim.config().seed,
            hash_every: (1.0 / sim.tick_secs()).round().max(1.0) as u16,
            players: 1,
            scene: words.join("/"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(scene: &str) -> Header {
        Header { pack_hash: 0, seed: 1, hash_every: 30, players: 1, scene: scene.into() }
    }

    #[test]
    fn scenes_of_the_demo_are_read_and_others_refused() {
        let setting = Setting::from_header(&header("empty/rapier/flat/3/actions")).unwrap();
        assert_eq!((setting.engine, setting.characters), (Engine::Rapier, 3));
        for wrong in [
            "arena/4",
            "empty/rapier/flat/0/actions",
            "empty/rapier/flat/3/actions/x",
            "moon/rapier/flat/3/actions",
        ] {
            let said = Setting::from_header(&header(wrong)).unwrap_err().to_string();
            assert!(said.contains("empty/rapier/flat/1/parameters") && said.contains(wrong), "{said}");
        }
        let two = Header { players: 2, ..header("empty/rapier/flat/1/parameters") };
        assert!(Setting::from_header(&two).is_err());
    }

    #[test]
    fn a_recording_steers_by_what_it_keeps() {
        let mut replaying = Replaying::Recording(Box::new(Recorder::new(header("empty")).unwrap()));
        let pad = GamepadState { left_stick: [0.123, 0.987], ..GamepadState::default() };
        let (steered, camera) = replaying.steer(&pad, Heading::from_angle(1.0)).unwrap();
        assert_ne!(steered.left_stick, pad.left_stick, "whole numbers");
        replaying.follow(&steered, camera, 5).unwrap();
        let mut playing = Replaying::Playing(Box::new(Playback::new(replaying.recorded().unwrap())));
        let (played, looked) = playing.steer(&GamepadState::default(), Heading::FORWARD).unwrap();
        assert_eq!((played, looked), (steered, camera));
        assert!(playing.follow(&played, looked, 6).is_err());
        assert!(playing.steer(&GamepadState::default(), Heading::FORWARD).is_none());
    }
}
