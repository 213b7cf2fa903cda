//! Sums over a run.

use std::time::Duration;

use physics_bridge::StateHash;

use super::TickTimes;

/// What a run adds up to, over all characters.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Totals {
    /// Ticks of all characters together.
    pub character_ticks: u64,
    /// Those spent lying or getting up.
    pub down_ticks: u64,
    /// Times a character fell.
    pub falls: u64,
    /// Times a character was stood up because it could not get up by itself, or its physics had diverged.
    pub stood_up: u64,
    /// Way of all root bodies together, seen from above, metres.
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
