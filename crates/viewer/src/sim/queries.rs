//! What can be asked of a world.

use std::sync::Arc;

use physics::{Character, Engine};
use physics_bridge::{BodyPoses, Model};
use policy_core::{BlendMode, CharacterPack};

use super::{Ghost, SimConfig, Simulation, SteeredCharacter, TickTimes, Totals};

impl Simulation {
    /// The pack.
    #[must_use]
    pub fn pack(&self) -> &Arc<CharacterPack> {
        &self.pack
    }

    /// Ground and settings.
    #[must_use]
    pub fn model(&self) -> &Model {
        self.model.described()
    }

    /// The engine that the characters live in.
    #[must_use]
    pub fn engine(&self) -> Engine {
        self.model.engine()
    }

    /// What it was made of.
    #[must_use]
    pub fn config(&self) -> &SimConfig {
        &self.config
    }

    /// Characters, the player's first.
    #[must_use]
    pub fn characters(&self) -> &[SteeredCharacter] {
        &self.steered
    }

    /// The player's character.
    #[must_use]
    pub fn player(&self) -> &SteeredCharacter {
        &self.steered[0]
    }

    /// Length of a control tick, seconds.
    #[must_use]
    pub fn tick_secs(&self) -> f32 {
        1.0 / self.model().control_hz()
    }

    /// How the player's controller makes an action of a blend.
    #[must_use]
    pub fn blend_mode(&self) -> BlendMode {
        self.player().controller.config().blend_mode
    }

    /// The physics of a character.
    ///
    /// # Panics
    /// When there is none of that index.
    #[must_use]
    pub fn character(&self, index: usize) -> &Character {
        self.crowd.character(index)
    }

    /// The physics of a character, to push it.
    ///
    /// # Panics
    /// When there is none of that index.
    pub fn character_mut(&mut self, index: usize) -> &mut Character {
        self.crowd.character_mut(index)
    }

    /// The second character of the side-by-side comparison.
    #[must_use]
    pub fn ghost(&self) -> Option<&Ghost> {
        self.ghost.as_ref()
    }

    /// Control ticks since it began.
    #[must_use]
    pub fn ticks(&self) -> u64 {
        self.ticks
    }

    /// Time the last tick took.
    #[must_use]
    pub fn times(&self) -> TickTimes {
        self.times
    }

    /// Sums over the whole run.
    #[must_use]
    pub fn totals(&self) -> &Totals {
        &self.totals
    }

    /// States that the player can be taken back by, and how far back it is now.
    #[must_use]
    pub fn history(&self) -> (usize, usize) {
        let player = self.crowd.character(0);
        (player.history_len().saturating_sub(1), player.history_age())
    }

    /// Poses of the ghost between the last two ticks.
    #[must_use]
    pub fn ghost_poses(&self, alpha: f32) -> Option<BodyPoses> {
        self.ghost.as_ref().map(|g| g.poses(alpha))
    }
}
