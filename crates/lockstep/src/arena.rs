//! The arena: flat ground, one character a player, crates between them.

use std::sync::Arc;

use physics_rapier::{Model, PropShape, World};
use policy_core::glam::{Quat, Vec2, Vec3};
use policy_core::{Button, CharacterPack, Heading};
use replay::{Header, MOST_PLAYERS, Pad, StateHash};

use crate::error::ArenaError;
use crate::player::{Player, PlayerView};

/// Most crates.
pub const MOST_CRATES: usize = 64;

/// Shoves every character, away from the camera of the player who presses it. That is also how a player falls to get up.
pub const SHOVE_BUTTON: Button = Button::LeftShoulder;

/// Distance between players at the start, metres.
const SPACING_M: f32 = 1.6;
/// Half the length of a crate, metres, and its mass.
const CRATE_HALF_M: f32 = 0.2;
const CRATE_KG: f32 = 5.0;

/// What an arena is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ArenaConfig {
    /// Characters, one a player: 1 to 8.
    pub players: usize,
    /// Crates that lie about, up to [`MOST_CRATES`].
    pub crates: usize,
    /// Places the crates.
    pub seed: u32,
}

impl Default for ArenaConfig {
    fn default() -> Self {
        Self { players: 1, crates: 4, seed: 1 }
    }
}

/// Several characters of one pack and props, stepped in fixed ticks by pads alone.
#[derive(Debug)]
pub struct Arena {
    config: ArenaConfig,
    pack_hash: u64,
    pub(crate) pack: Arc<CharacterPack>,
    pub(crate) world: World,
    pub(crate) players: Vec<Player>,
    pub(crate) tick: u64,
    dt_secs: f32,
    /// For the bytes of a controller's state, while it is hashed.
    scratch: Vec<u8>,
}

impl Arena {
    /// An arena at its start. `pack` is the bytes of a character pack of version 2, which brings its body. Allocates.
    ///
    /// # Errors
    /// When the bytes are no such pack, or a number of the configuration is out of its range.
    pub fn new(pack: &[u8], config: ArenaConfig) -> Result<Self, ArenaError> {
        if !(1..=MOST_PLAYERS).contains(&config.players) {
            return Err(ArenaError::Players { found: config.players });
        }
        if config.crates > MOST_CRATES {
            return Err(ArenaError::Crates { found: config.crates });
        }
        let pack_hash = StateHash::of(pack);
        let pack = Arc::new(CharacterPack::from_bytes(pack)?);
        let model = Model::for_pack(&pack)?;
        let mut world = World::new(&model);
        let mut players = Vec::with_capacity(config.players);
        for index in 0..config.players {
            let start = start_of(index, config.players);
            let character = world.add_character()?;
            world.stand_at(character, start.x, start.y, Heading::FORWARD, 0.0)?;
            let mut player = Player::new(&pack, start);
            world.sense_into(character, &mut player.state)?;
            player.stands();
            players.push(player);
        }
        for index in 0..config.crates {
            let at = crate_at(index, config.seed);
            world.add_prop(PropShape::Box { half_extents: [CRATE_HALF_M; 3] }, CRATE_KG, at)?;
        }
        let dt_secs = 1.0 / model.control_hz();
        Ok(Self { config, pack_hash, pack, world, players, tick: 0, dt_secs, scratch: Vec::new() })
    }

    /// What it was made of.
    #[must_use]
    pub fn config(&self) -> ArenaConfig {
        self.config
    }

    /// The pack of its characters.
    #[must_use]
    pub fn pack(&self) -> &Arc<CharacterPack> {
        &self.pack
    }

    /// The physics of its characters and props.
    #[must_use]
    pub fn world(&self) -> &World {
        &self.world
    }

    /// Control ticks so far.
    #[must_use]
    pub fn tick_count(&self) -> u64 {
        self.tick
    }

    /// Seconds of a control tick.
    #[must_use]
    pub fn tick_secs(&self) -> f32 {
        self.dt_secs
    }

    /// What a player's character does; `None` when there is no such player.
    #[must_use]
    pub fn player(&self, index: usize) -> Option<PlayerView<'_>> {
        self.players.get(index).map(Player::view)
    }

    /// Shape, centre in metres and rotation of each crate.
    pub fn crates(&self) -> impl Iterator<Item = (PropShape, Vec3, Quat)> + '_ {
        (0..self.world.prop_count()).filter_map(|index| self.world.prop(index))
    }

    /// The header of a replay of this arena, with a hash a second.
    #[must_use]
    pub fn header(&self) -> Header {
        Header {
            pack_hash: self.pack_hash,
            seed: self.config.seed,
            hash_every: (1.0 / self.dt_secs).round() as u16,
            players: self.config.players as u8,
            scene: format!("arena/{}", self.config.crates),
        }
    }

    /// Runs one control tick under one pad a player. A character whose motion became implausible is stood up at its start.
    ///
    /// # Errors
    /// When there are more or fewer pads than players; the arena is then unchanged.
    pub fn tick(&mut self, pads: &[Pad]) -> Result<(), ArenaError> {
        if pads.len() != self.players.len() {
            return Err(ArenaError::Pads { expected: self.players.len(), found: pads.len() });
        }
        for (index, &pad) in pads.iter().enumerate() {
            if self.players[index].presses(pad, SHOVE_BUTTON) {
                self.shove(pad.heading().direction())?;
            }
        }
        for (index, (player, &pad)) in self.players.iter_mut().zip(pads).enumerate() {
            let targets = player.decide(pad, self.dt_secs);
            self.world.actuate(index, targets)?;
        }
        self.world.step();
        self.world.reset_lost_props();
        for (index, player) in self.players.iter_mut().enumerate() {
            self.world.sense_into(index, &mut player.state)?;
            if self.world.check(&player.state).is_err() || player.lies_for_good(self.dt_secs) {
                let start = player.start;
                self.world.stand_at(index, start.x, start.y, Heading::FORWARD, 0.0)?;
                self.world.sense_into(index, &mut player.state)?;
                player.stood_up();
            }
        }
        self.tick += 1;
        Ok(())
    }

    /// A hash of everything that the next tick depends on. Allocates once.
    pub fn hash(&mut self) -> u64 {
        let mut hash = StateHash::new();
        hash.bytes(&self.tick.to_le_bytes());
        self.world.state_bits(|bits| hash.word(bits));
        for player in &mut self.players {
            player.hash_into(&mut hash, &mut self.scratch);
        }
        hash.value()
    }

    /// A shove along a direction for every character that stands and is not being shoved.
    fn shove(&mut self, direction: Vec2) -> Result<(), ArenaError> {
        for (index, player) in self.players.iter().enumerate() {
            if let Some((body, force, secs)) = player.shoved_along(direction)
                && !self.world.is_pushed(index, body)
            {
                self.world.push(index, body, force, secs)?;
            }
        }
        Ok(())
    }
}

/// Where a player starts: in a row across.
fn start_of(index: usize, players: usize) -> Vec2 {
    Vec2::new(0.0, (index as f32 - (players as f32 - 1.0) / 2.0) * SPACING_M)
}

/// Where a crate lies: in rows ahead of the players, each a little off.
fn crate_at(index: usize, seed: u32) -> Vec3 {
    let (row, column) = (index / 4, index % 4);
    let mixed = (index as u32 ^ seed.wrapping_mul(0x9e37_79b9)).wrapping_mul(0x85eb_ca6b);
    let off = |shift: u32| ((mixed >> shift) & 0xff) as f32 / 255.0 - 0.5;
    Vec3::new(
        3.0 + 1.5 * row as f32 + 0.8 * off(8),
        (column as f32 - 1.5) * 1.2 + 0.6 * off(20),
        CRATE_HALF_M,
    )
}
