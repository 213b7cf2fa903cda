//! A second player: takes over the first of the characters that wander, with a pad of its own.

use policy_core::{Bindings, Command, CommandMapper, GamepadState, Heading};

use super::Simulation;
use super::bodies::Bodies;

/// The character that a second player takes over.
pub const SECOND_CHARACTER: usize = 1;

/// A second player's pad, and what it did in the last tick.
#[derive(Debug)]
pub(super) struct SecondPlayer {
    mapper: CommandMapper,
    /// For the ticks from now on.
    pad: GamepadState,
    /// Of the last tick: buttons act when they go down.
    last_pad: GamepadState,
}

impl Simulation {
    /// The pad of a second player for the ticks from now on; `None` lets its character wander again. Returns false where there is
    /// no character for it: on the empty floor all characters follow the first player.
    pub fn set_second_pad(&mut self, pad: Option<&GamepadState>) -> bool {
        let has_character = self.has_second_character();
        self.second = match (pad, self.second.take()) {
            (Some(pad), Some(player)) => Some(SecondPlayer { pad: *pad, ..player }),
            // What is held when it joins has not just gone down.
            (Some(pad), None) if has_character => {
                let mapper = CommandMapper::new(&self.pack, &Bindings::default());
                Some(SecondPlayer { mapper, pad: *pad, last_pad: *pad })
            }
            _ => None,
        };
        pad.is_none() || has_character
    }

    /// True where there is a character for a second player.
    #[must_use]
    pub fn has_second_character(&self) -> bool {
        matches!(self.bodies, Bodies::Together(_)) && self.steered.len() > SECOND_CHARACTER
    }

    /// True while a second player steers a character.
    #[must_use]
    pub fn has_second_player(&self) -> bool {
        self.second.is_some()
    }

    /// The second player's tick: what its buttons throw, and the command for its character.
    pub(super) fn tick_second(&mut self, camera: Heading) -> Option<Command> {
        let mut second = self.second.take()?;
        let command = second.mapper.map(&second.pad, camera, &self.steered[SECOND_CHARACTER].state);
        self.throw(SECOND_CHARACTER, [&second.last_pad, &second.pad], camera);
        second.last_pad = second.pad;
        self.second = Some(second);
        Some(command)
    }
}
