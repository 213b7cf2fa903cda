//! How a world begins: ground, number and places of characters.

use std::sync::Arc;

use glam::{Vec2, Vec3};
use physics::{Character, Engine, Model, PhysicsCharacter};
use physics_bridge::{BodyPoses, Crowd, GroundKind, HISTORY_SECS, ModelError, Pose};
use policy_core::{Bindings, BlendMode, CharacterPack, CommandMapper, GamepadState, Heading};

use super::bodies::Bodies;
use super::rewind::PadRing;
use super::{
    Overrides, SceneKind, SharedWorld, Shove, SimError, Simulation, SteeredCharacter, TickTimes, Totals,
};
use crate::assets;
use playground::{Playground, WanderPath};

/// Most characters in one world.
pub const MAX_CHARACTERS: usize = 200;
/// Most characters that each keep the last ten seconds; 0.8 MB each.
const MAX_HISTORIES: usize = 16;
/// A character whose root is below this share of its standing height lies.
const LYING: f32 = 0.3;
/// Distance between neighbours at the start, metres.
const SPACING: f32 = 1.3;

/// What a world is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SimConfig {
    /// What stands on the floor. The playground is flat and in MuJoCo.
    pub scene: SceneKind,
    /// The physics.
    pub engine: Engine,
    /// The ground.
    pub ground: GroundKind,
    /// Characters, 1 to [`MAX_CHARACTERS`]; in the playground as many as it has starts.
    pub characters: usize,
    /// Places the hills and turns the crowd.
    pub seed: u32,
    /// Keep the last ten seconds, to rewind to, where the engine can.
    pub history: bool,
    /// Each character has a blend mode of its own and starts where the others do; as many as there are modes, on the
    /// empty floor.
    pub comparison: bool,
}

impl Default for SimConfig {
    fn default() -> Self {
        Self {
            scene: SceneKind::Empty,
            engine: Engine::default(),
            ground: GroundKind::Flat,
            characters: 1,
            seed: 1,
            history: false,
            comparison: false,
        }
    }
}

impl SimConfig {
    /// Where a character starts on the empty floor: the player at the origin, the others in a block behind it.
    #[must_use]
    pub fn start_of(&self, index: usize) -> Vec2 {
        if self.comparison {
            return Vec2::ZERO;
        }
        let side = (self.characters as f32).sqrt().ceil() as usize;
        let (row, column) = (index / side, index % side);
        // The player stands in the middle of the first row.
        let middle = side / 2;
        let column = match column {
            0 => middle,
            c if c <= middle => c - 1,
            c => c,
        };
        let across = (column as f32 - middle as f32) * SPACING;
        Vec2::new(-(row as f32) * SPACING, across)
    }

    /// The blend mode of a character where the others have `mode`.
    fn mode_of(&self, index: usize, mode: BlendMode) -> BlendMode {
        if self.comparison { BlendMode::ALL[index % BlendMode::ALL.len()] } else { mode }
    }

    /// Where a character looks at the start: the player along x, the others up to 20 degrees off.
    #[must_use]
    pub fn heading_of(&self, index: usize) -> Heading {
        if index == 0 || self.comparison {
            return Heading::FORWARD;
        }
        // A small mixing function of index and seed: the same everywhere, and nothing more is needed of it.
        let mixed = (index as u32 ^ self.seed.wrapping_mul(0x9e37_79b9)).wrapping_mul(0x85eb_ca6b);
        let fraction = (mixed >> 8) as f32 / 16_777_216.0;
        Heading::from_angle((fraction - 0.5) * 0.7)
    }
}

/// The body of a pack: the one that it brings, or the humanoid for packs of version 1.
///
/// # Errors
/// When the pack's MJCF is no character, or is not that of its skeleton.
pub fn model_of(pack: &CharacterPack) -> Result<physics_bridge::Model, ModelError> {
    match pack.mjcf() {
        Some(_) => physics_bridge::Model::for_pack(pack),
        None => {
            physics_bridge::Model::from_mjcf_with_skeleton(assets::HUMANOID_MJCF, Arc::clone(pack.skeleton()))
        }
    }
}

/// Where the bodies are with all joints at zero and the root upright at the origin, metres.
#[must_use]
pub fn rest_positions(model: &physics_bridge::Model) -> Vec<Vec3> {
    let mut character = physics_bridge::Character::new(model);
    let mut poses = BodyPoses::new(model.skeleton());
    let Pose { qpos, qvel } = Pose::new(model.skeleton());
    character.set_pose(&qpos, &qvel).expect("zeros and an upright root are a pose");
    character.poses_into(&mut poses);
    poses.positions
}

/// The parts of a world that depend on its characters.
struct Populated {
    bodies: Bodies,
    steered: Vec<SteeredCharacter>,
    pads: PadRing,
    shove: Shove,
}

impl Simulation {
    /// A world of the characters of `pack`.
    ///
    /// # Errors
    /// When the pack's body can't be simulated, or the number of characters is out of range.
    pub fn new(pack: Arc<CharacterPack>, config: SimConfig) -> Result<Self, SimError> {
        let described = model_of(&pack).map_err(physics::ModelError::from)?;
        let model =
            Model::new(&described, config.engine)?.with_terrain(config.ground.terrain(config.seed))?;
        let Populated { bodies, steered, pads, shove } =
            populate(&model, &pack, BlendMode::default(), config)?;
        let mapper = CommandMapper::new(&pack, &Bindings::default());
        Ok(Self {
            config,
            wander_path: WanderPath::of(&pack),
            pack,
            model,
            bodies,
            steered,
            ghost: None,
            playback: None,
            mapper,
            last_pad: GamepadState::default(),
            second: None,
            pads,
            shove,
            overrides: Overrides::default(),
            renews_controllers: false,
            ticks: 0,
            times: TickTimes::default(),
            totals: Totals::default(),
        })
    }

    /// Begins anew with another engine, ground or number of characters, and the same settings.
    ///
    /// # Errors
    /// When the number of characters is out of range, or the engine can't load the body; nothing is changed then.
    pub fn rebuild(&mut self, config: SimConfig) -> Result<(), SimError> {
        let model =
            Model::new(self.model(), config.engine)?.with_terrain(config.ground.terrain(config.seed))?;
        let populated = populate(&model, &self.pack, self.blend_mode(), config)?;
        self.config = config;
        self.replace(model, populated);
        Ok(())
    }

    /// Begins anew with the characters of another pack, on the same ground and with the same settings.
    ///
    /// # Errors
    /// When the pack's body can't be simulated; nothing is changed then.
    pub fn set_pack(&mut self, pack: Arc<CharacterPack>) -> Result<(), SimError> {
        let described = model_of(&pack).map_err(physics::ModelError::from)?;
        let model = Model::new(&described, self.config.engine)?
            .with_settings(self.model().settings())?
            .with_terrain(self.config.ground.terrain(self.config.seed))?;
        let populated = populate(&model, &pack, self.blend_mode(), self.config)?;
        self.mapper = CommandMapper::new(&pack, &Bindings::default());
        self.wander_path = WanderPath::of(&pack);
        self.overrides = Overrides::default();
        self.playback = None;
        self.pack = pack;
        self.replace(model, populated);
        Ok(())
    }

    /// Where a character starts, and where it looks.
    pub(super) fn start_of(&self, index: usize) -> (Vec2, Heading) {
        match &self.bodies {
            Bodies::Apart(_) => (self.config.start_of(index), self.config.heading_of(index)),
            Bodies::Together(shared) => {
                let start = shared.scene().starts[index];
                (start.at, Heading::from_angle(start.heading))
            }
        }
    }

    fn replace(&mut self, model: Model, populated: Populated) {
        self.model = model;
        (self.bodies, self.steered) = (populated.bodies, populated.steered);
        (self.pads, self.shove) = (populated.pads, populated.shove);
        (self.ghost, self.last_pad, self.second) = (None, GamepadState::default(), None);
        self.mapper.reset();
    }
}

fn populate(
    model: &Model,
    pack: &Arc<CharacterPack>,
    mode: BlendMode,
    config: SimConfig,
) -> Result<Populated, SimError> {
    let modes = BlendMode::ALL.len();
    if config.comparison && (config.scene != SceneKind::Empty || config.characters != modes) {
        return Err(SimError::Comparison { modes, found: config.characters });
    }
    let bodies = match config.scene {
        SceneKind::Empty => apart(model, config)?,
        SceneKind::Playground => together(model, config)?,
    };
    let steered: Vec<SteeredCharacter> = (0..config.characters)
        .map(|index| SteeredCharacter::new(Arc::clone(pack), config.mode_of(index, mode), bodies.of(index)))
        .collect();
    let skeleton = model.skeleton();
    let shove = Shove {
        body: skeleton.head().and_then(|head| skeleton.parent(head)).unwrap_or(skeleton.root()),
        least_height: LYING * steered[0].state.root_height(),
    };
    let mut pads = PadRing::new(model.described().control_hz(), &GamepadState::default());
    *pads.next() = GamepadState::default();
    Ok(Populated { bodies, steered, pads, shove })
}

/// Characters that each live alone.
fn apart(model: &Model, config: SimConfig) -> Result<Bodies, SimError> {
    if !(1..=MAX_CHARACTERS).contains(&config.characters) {
        return Err(SimError::Characters { found: config.characters });
    }
    let mut characters = Vec::with_capacity(config.characters);
    for index in 0..config.characters {
        let mut character = Character::new(model);
        let at = config.start_of(index);
        character.stand_at(at.x, at.y, config.heading_of(index), 0.0)?;
        if config.history && (index == 0 || config.characters <= MAX_HISTORIES) {
            character.record_history(HISTORY_SECS);
        }
        characters.push(character);
    }
    Ok(Bodies::Apart(Crowd::new(characters, None)?))
}

/// Characters in the world of the playground.
fn together(model: &Model, config: SimConfig) -> Result<Bodies, SimError> {
    if config.engine != Engine::Mujoco {
        return Err(SimError::NotInPlayground { said: "The playground runs in MuJoCo only." });
    }
    if config.ground != GroundKind::Flat {
        return Err(SimError::NotInPlayground { said: "The playground is on flat ground only." });
    }
    let scene = Playground::shipped()?;
    let shared = SharedWorld::new(scene, model.described(), config.characters, config.seed, config.history)?;
    Ok(Bodies::Together(Box::new(shared)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn starts_are_apart_and_the_player_is_at_the_origin() {
        for characters in [1, 2, 7, 100, MAX_CHARACTERS] {
            let config = SimConfig { characters, ..SimConfig::default() };
            let starts: Vec<Vec2> = (0..characters).map(|i| config.start_of(i)).collect();
            assert_eq!(starts[0], Vec2::ZERO);
            for (i, a) in starts.iter().enumerate() {
                assert!(starts[..i].iter().all(|b| a.distance(*b) > 1.2), "{characters}: {i} at {a}");
            }
        }
    }
}
