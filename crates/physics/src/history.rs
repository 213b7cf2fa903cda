//! What only MuJoCo keeps of a character: the last seconds, and each contact.

use physics_bridge::{Contact, ReplayFile};

use crate::character::{Body, Character, Diverged};

/// That state is not recorded.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("expected one of {recorded} recorded states, found {asked} ticks before the newest")]
#[non_exhaustive]
pub struct NotRecorded {
    /// Ticks before the newest.
    pub asked: usize,
    /// States recorded.
    pub recorded: usize,
}

impl Character {
    /// Keeps the states of the last `secs` seconds from now on; nothing where the engine keeps no history.
    pub fn record_history(&mut self, secs: f32) {
        if let Body::Mujoco(character) = &mut self.body {
            character.record_history(secs);
        }
    }

    /// States recorded, the present one included; 0 when none is recorded.
    #[must_use]
    pub fn history_len(&self) -> usize {
        match &self.body {
            Body::Mujoco(character) => character.history_len(),
            Body::Rapier(_) => 0,
        }
    }

    /// How many ticks before the newest recorded state the character is.
    #[must_use]
    pub fn history_age(&self) -> usize {
        match &self.body {
            Body::Mujoco(character) => character.history_age(),
            Body::Rapier(_) => 0,
        }
    }

    /// Goes to the state `age` ticks before the newest recorded one.
    ///
    /// # Errors
    /// When that many are not recorded; the character is then unchanged.
    pub fn rewind_to(&mut self, age: usize) -> Result<(), NotRecorded> {
        let recorded = self.history_len();
        match &mut self.body {
            Body::Mujoco(character) => character.rewind_to(age).ok(),
            Body::Rapier(_) => None,
        }
        .ok_or(NotRecorded { asked: age, recorded })
    }

    /// Where it touched during the last substep; nothing where the engine tells no contacts.
    #[must_use]
    pub fn contacts(&self) -> &[Contact] {
        match &self.body {
            Body::Mujoco(character) => character.contacts(),
            Body::Rapier(_) => &[],
        }
    }
}

impl Diverged {
    /// The state before the tick, to be saved and replayed, where the engine keeps it.
    #[must_use]
    pub fn replay(&self) -> Option<&ReplayFile> {
        match self {
            Diverged::Mujoco(diverged) => Some(&diverged.replay),
            Diverged::Rapier(_) => None,
        }
    }
}
