//! The last seconds of a character, to step back through.

use super::{Character, Snapshot};
use crate::ring::{MOST_SECS, NotRecorded, Ring};

/// How long a history usually is, seconds.
pub const HISTORY_SECS: f32 = 10.0;

/// The states of a character.
pub(super) type History = Ring<Snapshot>;

impl Character {
    /// Keeps the states of the last `secs` seconds from now on, usually [`HISTORY_SECS`]. Allocates them here: about
    /// 2.5 kB a tick for the humanoid. Forgets a history that was recorded before.
    pub fn record_history(&mut self, secs: f32) {
        let ticks = (secs.clamp(0.0, MOST_SECS) * self.model.control_hz()).round() as usize;
        let empty = || Snapshot::for_model(&self.model);
        self.history = Some(Box::new(Ring::new(ticks + 1, empty)));
        self.restart_history();
    }

    /// States recorded, the present one included; 0 when none is recorded.
    #[must_use]
    pub fn history_len(&self) -> usize {
        self.history.as_ref().map_or(0, |history| history.len())
    }

    /// How many ticks before the newest recorded state the character is: 0 unless it was rewound.
    #[must_use]
    pub fn history_age(&self) -> usize {
        self.history.as_ref().map_or(0, |history| history.age())
    }

    /// Goes to the state `age` ticks before the newest recorded one: 0 is the newest, `history_len() - 1` the
    /// oldest. Newer states stay recorded until the next [`Character::step`]. That step repeats the first one bit
    /// for bit if it gets the same targets.
    ///
    /// # Errors
    /// When that many are not recorded; the character is then unchanged.
    pub fn rewind_to(&mut self, age: usize) -> Result<(), NotRecorded> {
        let recorded = self.history_len();
        let Some(mut history) = self.history.take() else {
            return Err(NotRecorded { asked: age, recorded });
        };
        let found = history.at_age(age).map(|snapshot| self.load_state(snapshot));
        if found.is_some() {
            history.set_age(age);
        }
        self.history = Some(history);
        found.ok_or(NotRecorded { asked: age, recorded })
    }

    /// Forgets the recorded states and records the present one, if a history is recorded at all.
    pub(super) fn restart_history(&mut self) {
        if let Some(history) = &mut self.history {
            history.clear();
            history.next_slot().record(&self.data, self.tick, &self.pushes);
        }
    }
}
