//! What can be asked of a world.

use std::sync::Arc;

use glam::{Vec2, Vec3};
use physics::{Character, Engine};
use physics_bridge::{BodyPoses, Model};
use policy_core::{BlendMode, CharacterPack};

use super::bodies::Bodies;
use super::{Ghost, GroundContact, SharedWorld, SimConfig, Simulation, SteeredCharacter, TickTimes, Totals};

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

    /// The physics of a character on the empty floor.
    ///
    /// # Panics
    /// When there is none of that index, or the characters share a world.
    #[must_use]
    pub fn character(&self, index: usize) -> &Character {
        match &self.bodies {
            Bodies::Apart(crowd) => crowd.character(index),
            Bodies::Together(_) => panic!("expected characters on the empty floor, found a shared world"),
        }
    }

    /// The physics of a character on the empty floor, to change it.
    ///
    /// # Panics
    /// As [`Simulation::character`].
    pub fn character_mut(&mut self, index: usize) -> &mut Character {
        match &mut self.bodies {
            Bodies::Apart(crowd) => crowd.character_mut(index),
            Bodies::Together(_) => panic!("expected characters on the empty floor, found a shared world"),
        }
    }

    /// The world that all characters share with props; `None` on the empty floor.
    #[must_use]
    pub fn shared(&self) -> Option<&SharedWorld> {
        match &self.bodies {
            Bodies::Apart(_) => None,
            Bodies::Together(shared) => Some(shared),
        }
    }

    /// The same, to throw and to hold.
    pub fn shared_mut(&mut self) -> Option<&mut SharedWorld> {
        match &mut self.bodies {
            Bodies::Apart(_) => None,
            Bodies::Together(shared) => Some(shared),
        }
    }

    /// True when the last seconds of a character are kept.
    ///
    /// # Panics
    /// When there is none of that index.
    #[must_use]
    pub fn keeps_history(&self, index: usize) -> bool {
        self.bodies.of(index).keeps_history()
    }

    /// Where a character touches the ground, or what it touches in a shared world.
    ///
    /// # Panics
    /// When there is none of that index.
    #[must_use]
    pub fn ground_contacts(&self, index: usize) -> Vec<GroundContact> {
        self.bodies.of(index).ground_contacts()
    }

    /// Centre of mass of a character, metres.
    ///
    /// # Panics
    /// When there is none of that index.
    #[must_use]
    pub fn centre_of_mass(&self, index: usize) -> Vec3 {
        self.bodies.of(index).centre_of_mass()
    }

    /// Height of the ground at a point: of the terrain, or of what stands on it and is not above `below`. Metres.
    #[must_use]
    pub fn height_at(&self, at: Vec2, below: f32) -> f32 {
        let ground = self.model().height_at(at.x, at.y);
        self.shared().map_or(ground, |shared| shared.scene().height_at(at, below).max(ground))
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

    /// Threads that the controllers of a tick are spread over.
    #[must_use]
    pub fn control_threads(&self) -> usize {
        match &self.bodies {
            Bodies::Apart(crowd) => crowd.threads().min(self.steered.len()).max(1),
            Bodies::Together(_) => 1,
        }
    }

    /// Sums over the whole run.
    #[must_use]
    pub fn totals(&self) -> &Totals {
        &self.totals
    }

    /// States that the player can be taken back by, and how far back it is now.
    #[must_use]
    pub fn history(&self) -> (usize, usize) {
        match &self.bodies {
            Bodies::Apart(crowd) => {
                let player = crowd.character(0);
                (player.history_len().saturating_sub(1), player.history_age())
            }
            Bodies::Together(shared) => shared.history(),
        }
    }

    /// Poses of the ghost between the last two ticks.
    #[must_use]
    pub fn ghost_poses(&self, alpha: f32) -> Option<BodyPoses> {
        self.ghost.as_ref().map(|g| g.poses(alpha))
    }
}
