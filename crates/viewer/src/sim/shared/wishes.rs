//! The commands of the players, and of the characters that wander.

use playground::WanderPath;
use policy_core::Command;

use super::SharedWorld;
use crate::sim::SteeredCharacter;

impl SharedWorld {
    /// Gives the players their commands, the first characters in order, and those that wander theirs.
    pub(in crate::sim) fn give_commands(
        &mut self,
        players: [Option<&Command>; 2],
        path: WanderPath,
        steered: &mut [SteeredCharacter],
        dt_secs: f32,
    ) {
        for (index, character) in steered.iter_mut().enumerate() {
            let at = character.position();
            // The first character does not wander.
            let wanderer = index.checked_sub(1).and_then(|index| self.state.wanderers.get_mut(index));
            // One that a player has taken over wanders on where it finds itself afterwards.
            let wish = wanderer.map(|wanderer| wanderer.tick(at, dt_secs));
            match (players.get(index).copied().flatten(), wish) {
                (Some(command), _) => character.receive(command, at),
                (None, Some(wish)) => character.command = path.command(wish, at),
                (None, None) => {}
            }
        }
    }
}
