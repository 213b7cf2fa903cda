//! The whole state of a character, to come back to: it goes on from there bit for bit.

use std::sync::Arc;

use mujoco_rs::wrappers::mj_data::MjData;
use mujoco_rs::wrappers::mj_model::MjModel;

use crate::character::Character;
use crate::model::{Model, STATE};
use crate::push::Pushes;

/// State of a [`Character`] at the end of a control tick: position, velocity, joint targets, pushes, the
/// solver's start, time. About 2.5 kB. Settings and terrain belong to the [`Model`] and are not in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    pub(crate) state: Box<[f64]>,
    pub(crate) tick: u64,
    pub(crate) pushes: Pushes,
}

/// The snapshot is of a character of another kind.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("expected a snapshot of {expected} numbers, found {found}")]
#[non_exhaustive]
pub struct SnapshotMismatch {
    /// Numbers in the state of the character.
    pub expected: usize,
    /// Numbers in the snapshot.
    pub found: usize,
}

impl Snapshot {
    /// Room for the state of a character of `model`; all zero, so fill it before restoring it.
    pub(crate) fn for_model(model: &Model) -> Self {
        let state = vec![0.0; model.physics().state_size(STATE)].into_boxed_slice();
        Self { state, tick: 0, pushes: Pushes::default() }
    }

    /// Control ticks that the character had completed.
    #[must_use]
    pub fn tick(&self) -> u64 {
        self.tick
    }

    /// A number that is the same for the same state, bit for bit, and hardly ever for another (64-bit
    /// FNV-1a of the state, the tick and nothing else).
    #[must_use]
    pub fn hash(&self) -> u64 {
        let bytes = self.state.iter().map(|v| v.to_bits()).chain([self.tick]).flat_map(u64::to_le_bytes);
        bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
        })
    }

    /// Overwrites this with the given state. The length must fit.
    pub(crate) fn record(&mut self, data: &MjData<Arc<MjModel>>, tick: u64, pushes: &Pushes) {
        data.read_state_into(STATE, &mut self.state);
        self.tick = tick;
        self.pushes = *pushes;
    }
}

impl Character {
    /// The state now.
    #[must_use]
    pub fn save(&self) -> Snapshot {
        let mut snapshot = Snapshot::for_model(&self.model);
        snapshot.record(&self.data, self.tick, &self.pushes);
        snapshot
    }

    /// Overwrites `out` with the state now. Allocates only when `out` is of another kind of character.
    pub fn save_into(&self, out: &mut Snapshot) {
        if out.state.len() == self.before.state.len() {
            out.record(&self.data, self.tick, &self.pushes);
        } else {
            *out = self.save();
        }
    }

    /// Returns to a saved state and goes on from there bit for bit. The recorded history ends; it begins
    /// anew with this state.
    ///
    /// # Errors
    /// When the snapshot is of a character of another kind; the character is then unchanged.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<(), SnapshotMismatch> {
        let expected = self.before.state.len();
        if snapshot.state.len() != expected {
            return Err(SnapshotMismatch { expected, found: snapshot.state.len() });
        }
        self.take_up(snapshot);
        self.restart_history();
        Ok(())
    }

    /// Returns to a state of the right length and leaves the history as it is.
    pub(crate) fn take_up(&mut self, snapshot: &Snapshot) {
        if self.data.warning().iter().any(|w| w.number > 0) {
            self.data.reset(); // only this clears the counters
        }
        self.data.set_state(&snapshot.state, STATE).expect("the length was checked");
        self.tick = snapshot.tick;
        self.pushes = snapshot.pushes;
        self.refresh();
    }
}
