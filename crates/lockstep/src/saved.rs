//! The whole state of an arena as a value.

use physics_rapier::WorldSnapshot;
use playground::{LooseKind, Race, Wanderer};

use crate::arena::Arena;
use crate::error::ArenaError;
use crate::player::PlayerState;

/// Physics, contacts, controllers, pads, wanderers, what was thrown and the clock of the course at the end of a tick.
#[derive(Clone, Debug)]
pub struct ArenaState {
    world: WorldSnapshot,
    players: Vec<PlayerState>,
    wanderers: Vec<Wanderer>,
    races: Vec<Race>,
    loose: Vec<LooseKind>,
    tick: u64,
}

impl ArenaState {
    /// Control ticks that were completed.
    #[must_use]
    pub fn tick_count(&self) -> u64 {
        self.tick
    }
}

impl Arena {
    /// The state now. Allocates.
    #[must_use]
    pub fn save(&self) -> ArenaState {
        ArenaState {
            world: self.world.save(),
            players: self.players.iter().map(crate::player::Player::save).collect(),
            wanderers: self.wanderers.clone(),
            races: self.races.clone(),
            loose: self.loose.clone(),
            tick: self.tick,
        }
    }

    /// Returns to a state: the same pads give the same bits again. Allocates.
    ///
    /// # Errors
    /// When another arena saved the state; this one is then unchanged.
    pub fn restore(&mut self, state: &ArenaState) -> Result<(), ArenaError> {
        let fits = self.players.len() == state.players.len()
            && self.races.len() == state.races.len()
            && self.players.iter().zip(&state.players).all(|(player, saved)| player.fits(saved));
        if !fits {
            return Err(ArenaError::State);
        }
        self.world.restore(&state.world).map_err(|_| ArenaError::State)?;
        for (player, saved) in self.players.iter_mut().zip(&state.players) {
            player.restore(saved)?;
        }
        self.wanderers.clone_from(&state.wanderers);
        self.races.clone_from(&state.races);
        self.loose.clone_from(&state.loose);
        self.tick = state.tick;
        Ok(())
    }
}
