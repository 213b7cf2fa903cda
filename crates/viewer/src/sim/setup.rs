//! How a world begins: ground, number and places of characters.

use std::sync::Arc;

use glam::Vec2;
use physics_bridge::{Character, Crowd, GroundKind, HISTORY_SECS, Model};
use policy_core::{Bindings, Buttons, CharacterPack, CommandMapper, Heading};

use super::{Actor, Overrides, SimError, Simulation, TickTimes, Totals};

/// Most characters in one world.
pub const MAX_CHARACTERS: usize = 200;
/// Most characters that each keep the last ten seconds; 0.8 MB each.
const MAX_HISTORIES: usize = 16;
/// Distance between neighbours at the start, metres.
const SPACING: f32 = 1.3;

/// What a world is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SimConfig {
    /// The ground.
    pub ground: GroundKind,
    /// Characters, 1 to [`MAX_CHARACTERS`].
    pub characters: usize,
    /// Places the hills and turns the crowd.
    pub seed: u32,
    /// Keep the last ten seconds, to go back to.
    pub history: bool,
}

impl Default for SimConfig {
    fn default() -> Self {
        Self { ground: GroundKind::Flat, characters: 1, seed: 1, history: false }
    }
}

impl SimConfig {
    /// Where a character starts: the player at the origin, the others in a block behind it.
    #[must_use]
    pub fn start_of(&self, index: usize) -> Vec2 {
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

    /// Where a character looks at the start: the player along x, the others up to 20 degrees off.
    #[must_use]
    pub fn heading_of(&self, index: usize) -> Heading {
        if index == 0 {
            return Heading::FORWARD;
        }
        // A small mixing function of index and seed: the same everywhere, and nothing more is needed of it.
        let mixed = (index as u32 ^ self.seed.wrapping_mul(0x9e37_79b9)).wrapping_mul(0x85eb_ca6b);
        let fraction = (mixed >> 8) as f32 / 16_777_216.0;
        Heading::from_angle((fraction - 0.5) * 0.7)
    }
}

impl Simulation {
    /// A world of the humanoid `mjcf`, its controllers made of `pack`.
    ///
    /// # Errors
    /// When the MJCF is not of the humanoid, or the number of characters is out of range.
    pub fn new(mjcf: &str, pack: Arc<CharacterPack>, config: SimConfig) -> Result<Self, SimError> {
        let model = Model::from_mjcf(mjcf)?.with_terrain(config.ground.terrain(config.seed))?;
        let (crowd, actors) = populate(&model, &pack, config)?;
        let mapper = CommandMapper::new(&pack, &Bindings::default());
        Ok(Self {
            config,
            pack,
            model,
            crowd,
            actors,
            ghost: None,
            playback: None,
            mapper,
            shove_held: Buttons::NONE,
            overrides: Overrides::default(),
            ticks: 0,
            times: TickTimes::default(),
            totals: Totals::default(),
        })
    }

    /// Begins anew with another ground or number of characters, and the same settings.
    ///
    /// # Errors
    /// When the number of characters is out of range; nothing is changed then.
    pub fn rebuild(&mut self, config: SimConfig) -> Result<(), SimError> {
        let model = self.model.with_terrain(config.ground.terrain(config.seed))?;
        let (crowd, actors) = populate(&model, &self.pack, config)?;
        (self.model, self.crowd, self.actors, self.config) = (model, crowd, actors, config);
        self.ghost = None;
        self.mapper.reset();
        Ok(())
    }

    /// Goes on with another pack; everybody begins anew.
    pub fn set_pack(&mut self, pack: Arc<CharacterPack>) {
        self.mapper = CommandMapper::new(&pack, &Bindings::default());
        self.overrides = Overrides::default();
        self.ghost = None;
        for (actor, character) in self.actors.iter_mut().zip(self.crowd.characters()) {
            *actor = Actor::new(Arc::clone(&pack), character);
        }
        self.pack = pack;
        self.reset();
    }
}

fn populate(
    model: &Model,
    pack: &Arc<CharacterPack>,
    config: SimConfig,
) -> Result<(Crowd, Vec<Actor>), SimError> {
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
    let actors = characters.iter().map(|c| Actor::new(Arc::clone(pack), c)).collect();
    Ok((Crowd::new(characters, None)?, actors))
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
