//! The whole state of a character, to return to: it continues from there bit for bit.

use std::sync::Arc;

use mujoco_rs::wrappers::mj_data::MjData;
use mujoco_rs::wrappers::mj_model::MjModel;
use policy_core::contract::Pose;

use super::Character;
use super::push::Pushes;
use crate::description::model::{Model, STATE};

/// State of a [`Character`] at the end of a control tick: position, velocity, joint targets, pushes, the
/// solver's start, time. About 2.5 kB for the humanoid. Settings and terrain belong to the [`Model`] and are not in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    pub(super) state: Box<[f64]>,
    pub(super) tick: u64,
    pub(super) pushes: Pushes,
}

/// 64-bit FNV-1a over the bits of numbers in order. Equal runs have equal hashes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StateHash(u64);

impl Default for StateHash {
    /// The hash of nothing.
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl StateHash {
    /// Absorbs 64 bits, the lowest byte first.
    pub fn absorb_bits(&mut self, bits: u64) {
        for byte in bits.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    /// Absorbs every number of a pose, positions first.
    pub fn absorb(&mut self, pose: &Pose) {
        pose.qpos.iter().chain(&pose.qvel).for_each(|number| self.absorb_bits(number.to_bits()));
    }

    /// The hash of a physics state after `tick` control ticks.
    pub(crate) fn of_state(state: &[f64], tick: u64) -> u64 {
        let mut hash = Self::default();
        state.iter().map(|v| v.to_bits()).chain([tick]).for_each(|bits| hash.absorb_bits(bits));
        hash.value()
    }

    /// The hash of all that was absorbed.
    #[must_use]
    pub fn value(self) -> u64 {
        self.0
    }
}

impl std::fmt::Display for StateHash {
    /// Sixteen hexadecimal digits.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:016x}", self.0)
    }
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
    pub(super) fn for_model(model: &Model) -> Self {
        let state = vec![0.0; model.physics().state_size(STATE)].into_boxed_slice();
        Self { state, tick: 0, pushes: Pushes::new(model.skeleton()) }
    }

    /// Control ticks that the character had completed.
    #[must_use]
    pub fn tick(&self) -> u64 {
        self.tick
    }

    /// A number that is the same for the same state, bit for bit, and hardly ever for another: the
    /// [`StateHash`] of the state and the tick.
    #[must_use]
    pub fn hash(&self) -> u64 {
        StateHash::of_state(&self.state, self.tick)
    }

    /// Copies `other`. Allocates only when it is of another kind of character.
    pub fn copy_from(&mut self, other: &Self) {
        if self.state.len() == other.state.len() && self.pushes.fit(other.pushes.len()) {
            self.state.copy_from_slice(&other.state);
            self.pushes.copy_from(&other.pushes);
            self.tick = other.tick;
        } else {
            self.clone_from(other);
        }
    }

    fn fits(&self, character: &Character) -> bool {
        let own = &character.before;
        self.state.len() == own.state.len() && self.pushes.fit(own.pushes.len())
    }

    /// Overwrites this with the given state of the same kind of character.
    pub(super) fn record(&mut self, data: &MjData<Arc<MjModel>>, tick: u64, pushes: &Pushes) {
        data.read_state_into(STATE, &mut self.state);
        self.tick = tick;
        self.pushes.copy_from(pushes);
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
        if out.fits(self) {
            out.record(&self.data, self.tick, &self.pushes);
        } else {
            *out = self.save();
        }
    }

    /// Returns to a saved state and continues from there bit for bit. The recorded history ends; it starts again
    /// with this state.
    ///
    /// # Errors
    /// When the snapshot is of a character of another kind; the character is then unchanged.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<(), SnapshotMismatch> {
        if !snapshot.fits(self) {
            let (expected, found) = (self.before.state.len(), snapshot.state.len());
            return Err(SnapshotMismatch { expected, found });
        }
        self.load_state(snapshot);
        self.restart_history();
        Ok(())
    }

    /// Returns to a state of the same kind of character and leaves the history as it is.
    pub(super) fn load_state(&mut self, snapshot: &Snapshot) {
        if self.data.warning().iter().any(|w| w.number > 0) {
            self.data.reset(); // only this clears the counters
        }
        self.data
            .set_state(&snapshot.state, STATE)
            .expect("the length was checked, and no model has a history of delays");
        self.tick = snapshot.tick;
        self.pushes.copy_from(&snapshot.pushes);
        self.refresh();
    }
}
