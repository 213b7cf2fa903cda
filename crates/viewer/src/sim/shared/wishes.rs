//! From what a wanderer wants to a command.

use policy_core::{CharacterPack, Command, Goal, PathId};

use super::SharedWorld;
use crate::playground::Wish;
use crate::sim::SteeredCharacter;

/// How far ahead a wanderer's target is, metres: as far as a full stick's.
const AHEAD_M: f32 = 5.0;
/// A wanderer in a hurry is so far along the speed path behind its second node.
const HURRY: f32 = 0.25;

/// The path that wanderers move along.
#[derive(Clone, Copy, Debug)]
pub(in crate::sim) struct Wishes {
    path: Option<(PathId, f32)>,
}

impl Wishes {
    /// Along the path of the stick, where the pack has one.
    pub(in crate::sim) fn new(pack: &CharacterPack) -> Self {
        let named = pack.graph().path_named(&policy_core::Bindings::default().stick_path);
        Self { path: named.map(|path| (path, pack.graph().path(path).end())) }
    }

    fn command(self, wish: Wish, character: &SteeredCharacter) -> Command {
        let goal = |coordinate: f32| match self.path {
            Some((path, end)) => Goal::Path { path, coordinate: coordinate.min(end) },
            None => Goal::Stay,
        };
        match wish.direction {
            Some(direction) => Command {
                target: Some(character.position() + direction * AHEAD_M),
                goal: goal(1.0 + HURRY * wish.haste),
                ..Command::default()
            },
            None => Command { goal: goal(0.0), ..Command::default() },
        }
    }
}

impl SharedWorld {
    /// Gives the players their commands, the first characters in order, and those that wander theirs.
    pub(in crate::sim) fn give_commands(
        &mut self,
        players: [Option<&Command>; 2],
        wishes: Wishes,
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
                (None, Some(wish)) => character.command = wishes.command(wish, character),
                (None, None) => {}
            }
        }
    }
}
