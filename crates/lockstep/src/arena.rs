//! The arena: one character a player, others that wander, and what stands and lies about.

use std::sync::Arc;

use physics_rapier::{Model, World};
use playground::{LooseKind, Playground, Race, WanderPath, Wanderer};
use policy_core::glam::Vec2;
use policy_core::{Button, CharacterPack, Heading};
use replay::{Header, Pad, StateHash};

use crate::error::ArenaError;
use crate::player::{Player, PlayerView};
use crate::scene::ArenaConfig;

/// Shoves every character, away from the camera of the player who presses it. That is also how a player falls to get up.
pub const SHOVE_BUTTON: Button = Button::LeftShoulder;

/// Several characters of one pack and props, stepped in fixed ticks by pads alone.
#[derive(Debug)]
pub struct Arena {
    config: ArenaConfig,
    layout: Arc<Playground>,
    wander_path: WanderPath,
    pack_hash: u64,
    pub(crate) pack: Arc<CharacterPack>,
    pub(crate) world: World,
    /// Those with a pad, then those that wander.
    pub(crate) players: Vec<Player>,
    pub(crate) wanderers: Vec<Wanderer>,
    /// One for each player.
    pub(crate) races: Vec<Race>,
    /// What was thrown and put down: the props of the world after those of the layout.
    pub(crate) loose: Vec<LooseKind>,
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
        let layout = config.layout()?;
        let pack_hash = StateHash::of(pack);
        let pack = Arc::new(CharacterPack::from_bytes(pack)?);
        let model = Model::for_pack(&pack)?;
        let mut world = World::new(&model);
        for painted in &layout.fixtures {
            world.add_fixture(&painted.fixture)?;
        }
        let mut players = Vec::with_capacity(layout.starts.len());
        for start in &layout.starts {
            let character = world.add_character()?;
            let heading = Heading::from_angle(start.heading);
            world.stand_at(character, start.at.x, start.at.y, heading, 0.0)?;
            let mut player = Player::new(&pack, start.at, heading);
            world.sense_into(character, &mut player.state)?;
            player.stands();
            players.push(player);
        }
        for placed in &layout.props {
            let index = world.add_prop(&placed.prop, &placed.start())?;
            if let Some(joint) = &placed.joint {
                world.join(index, None, joint)?;
            }
        }
        let wanderer = |(index, start): (usize, &playground::Start)| {
            Wanderer::new(start.zone, start.heading, config.seed.into(), index as u64)
        };
        let wanderers = layout.starts.iter().enumerate().skip(config.players).map(wanderer).collect();
        let wander_path = WanderPath::of(&pack);
        let races = vec![Race::default(); config.players];
        let dt_secs = 1.0 / model.control_hz();
        Ok(Self {
            config,
            layout,
            wander_path,
            pack_hash,
            pack,
            world,
            players,
            wanderers,
            races,
            loose: Vec::new(),
            tick: 0,
            dt_secs,
            scratch: Vec::new(),
        })
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

    /// What stands there.
    #[must_use]
    pub fn layout(&self) -> &Arc<Playground> {
        &self.layout
    }

    /// A player's run over the course; `None` when there is no such player.
    #[must_use]
    pub fn race(&self, player: usize) -> Option<&Race> {
        self.races.get(player)
    }

    /// Characters: the players and those that wander.
    #[must_use]
    pub fn character_count(&self) -> usize {
        self.players.len()
    }

    /// What a character does; `None` when there is no such character. The first ones are the players'.
    #[must_use]
    pub fn player(&self, index: usize) -> Option<PlayerView<'_>> {
        self.players.get(index).map(Player::view)
    }

    /// The header of a replay of this arena, with a hash a second.
    #[must_use]
    pub fn header(&self) -> Header {
        Header {
            pack_hash: self.pack_hash,
            seed: self.config.seed,
            hash_every: (1.0 / self.dt_secs).round() as u16,
            players: self.config.players as u8,
            scene: self.config.scene.name(),
        }
    }

    /// Runs one control tick under one pad a player. A character whose motion became implausible is stood up at its start.
    ///
    /// # Errors
    /// When there are more or fewer pads than players; the arena is then unchanged.
    pub fn tick(&mut self, pads: &[Pad]) -> Result<(), ArenaError> {
        if pads.len() != self.config.players {
            return Err(ArenaError::Pads { expected: self.config.players, found: pads.len() });
        }
        for (index, &pad) in pads.iter().enumerate() {
            if self.players[index].presses(pad, SHOVE_BUTTON) {
                self.shove(pad.heading().direction())?;
            }
            self.throw(index, pad)?;
        }
        for (index, player) in self.players.iter_mut().enumerate() {
            let targets = match pads.get(index) {
                Some(&pad) => player.decide(pad, self.dt_secs),
                None => {
                    let at = player.state.root().position.truncate();
                    let wish = self.wanderers[index - pads.len()].tick(at, self.dt_secs);
                    player.follow(&self.wander_path.command(wish, at), self.dt_secs)
                }
            };
            self.world.actuate(index, targets)?;
        }
        self.drive_swings()?;
        self.world.step();
        self.world.reset_lost_props();
        for (index, player) in self.players.iter_mut().enumerate() {
            self.world.sense_into(index, &mut player.state)?;
            if self.world.check(&player.state).is_err() || player.lies_for_good(self.dt_secs) {
                let (start, heading) = player.start;
                self.world.stand_at(index, start.x, start.y, heading, 0.0)?;
                self.world.sense_into(index, &mut player.state)?;
                player.stood_up();
            }
        }
        for (race, player) in self.races.iter_mut().zip(&self.players) {
            let (at, down) = (player.state.root().position.truncate(), player.is_down());
            race.tick(&self.layout.checkpoints, at, down);
        }
        self.tick += 1;
        Ok(())
    }

    /// Keeps pendulums at their height.
    fn drive_swings(&mut self) -> Result<(), ArenaError> {
        for (index, placed) in self.layout.props.iter().enumerate() {
            let motion = self.world.prop(index).map(|(_, motion)| motion);
            if let Some(force) = motion.and_then(|motion| placed.swing_force(&motion)) {
                self.world.push_prop(index, force)?;
            }
        }
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
        self.loose.iter().for_each(|kind| hash.word(*kind as u32));
        for wanderer in &self.wanderers {
            wanderer.bits(|word| hash.word(word));
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
