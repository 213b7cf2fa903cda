//! Sums over a run.

use std::time::Duration;

use physics_bridge::Pose;

use super::TickTimes;

/// What a run adds up to, over all characters.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Totals {
    /// Ticks of all characters together.
    pub character_ticks: u64,
    /// Those spent lying or rising.
    pub down_ticks: u64,
    /// Times a character fell.
    pub falls: u64,
    /// Times a character was stood up again because it could not by itself, or had blown up.
    pub stood_up: u64,
    /// Way of all pelvises together, seen from above, metres.
    pub distance_m: f64,
    /// Time in controllers, on all threads together.
    pub policy: Duration,
    /// Time in ticks, on the clock.
    pub whole: Duration,
    /// Of every position and velocity.
    pub hash: StateHash,
}

impl Totals {
    pub(super) fn tick(&mut self, distance: f32, down: bool, fell: bool) {
        self.character_ticks += 1;
        self.down_ticks += u64::from(down);
        self.falls += u64::from(fell);
        if distance.is_finite() {
            self.distance_m += f64::from(distance);
        }
    }

    pub(super) fn times(&mut self, times: TickTimes) {
        self.policy += times.policy;
        self.whole += times.whole;
    }
}

/// FNV-1a over the bits of every `qpos` and `qvel` in order: equal runs have equal hashes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StateHash(u64);

impl Default for StateHash {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl StateHash {
    /// Takes in one character's state.
    pub fn absorb(&mut self, pose: &Pose) {
        for number in pose.qpos.iter().chain(&pose.qvel) {
            for byte in number.to_bits().to_le_bytes() {
                self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
            }
        }
    }
}

impl std::fmt::Display for StateHash {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:016x}", self.0)
    }
}
