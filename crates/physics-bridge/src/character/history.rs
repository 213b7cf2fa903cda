//! The last seconds of a character, to step back through.

use super::{Character, Snapshot};
use crate::description::model::Model;

/// How long a history usually is, seconds.
pub const HISTORY_SECS: f32 = 10.0;

/// Longest history, seconds: about 250 MB for the humanoid.
const MOST_SECS: f32 = 3600.0;

/// No such state is recorded.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("expected to go back fewer than {recorded} recorded ticks, found {asked}")]
#[non_exhaustive]
pub struct NotRecorded {
    /// How far back was asked for, ticks.
    pub asked: usize,
    /// States recorded, the newest included; 0 when nothing is.
    pub recorded: usize,
}

/// A ring of snapshots, all allocated at the start.
#[derive(Debug)]
pub(super) struct History {
    slots: Box<[Snapshot]>,
    /// Slot of the newest state.
    newest: usize,
    /// States recorded.
    len: usize,
    /// How many ticks before the newest the character is.
    age: usize,
}

impl History {
    fn new(model: &Model, secs: f32) -> Self {
        let ticks = (secs.clamp(0.0, MOST_SECS) * model.control_hz()).round() as usize;
        let slots = vec![Snapshot::for_model(model); ticks + 1].into_boxed_slice();
        Self { slots, newest: 0, len: 0, age: 0 }
    }

    /// The slot for the state that follows the present one; what came after that is forgotten.
    pub(super) fn next_slot(&mut self) -> &mut Snapshot {
        let capacity = self.slots.len();
        self.newest = (self.newest + capacity - self.age + 1) % capacity;
        self.len = (self.len - self.age + 1).min(capacity);
        self.age = 0;
        &mut self.slots[self.newest]
    }

    fn at_age(&self, age: usize) -> Option<&Snapshot> {
        (age < self.len).then(|| &self.slots[(self.newest + self.slots.len() - age) % self.slots.len()])
    }
}

impl Character {
    /// Keeps the states of the last `secs` seconds from now on, usually [`HISTORY_SECS`]. Allocates them here: about
    /// 2.5 kB a tick for the humanoid. Forgets a history that was recorded before.
    pub fn record_history(&mut self, secs: f32) {
        self.history = Some(Box::new(History::new(&self.model, secs)));
        self.restart_history();
    }

    /// States recorded, the present one included; 0 when none is recorded.
    #[must_use]
    pub fn history_len(&self) -> usize {
        self.history.as_ref().map_or(0, |history| history.len)
    }

    /// How many ticks before the newest recorded state the character is: 0 unless it was rewound.
    #[must_use]
    pub fn history_age(&self) -> usize {
        self.history.as_ref().map_or(0, |history| history.age)
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
            history.age = age;
        }
        self.history = Some(history);
        found.ok_or(NotRecorded { asked: age, recorded })
    }

    /// Forgets the recorded states and records the present one, if a history is recorded at all.
    pub(super) fn restart_history(&mut self) {
        if let Some(history) = &mut self.history {
            (history.len, history.age) = (0, 0);
            history.next_slot().record(&self.data, self.tick, &self.pushes);
        }
    }
}
