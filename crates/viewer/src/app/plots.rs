//! Curves over time, for the profiler and the gauges.

use std::collections::VecDeque;

use crate::sim::Simulation;

/// Points of a curve.
const POINTS: usize = 300;

/// One curve.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series(VecDeque<f32>);

impl Series {
    /// Adds a point; the oldest goes.
    pub fn push(&mut self, value: f32) {
        if self.0.len() == POINTS {
            self.0.pop_front();
        }
        self.0.push_back(value);
    }

    /// The newest point.
    #[must_use]
    pub fn last(&self) -> Option<f32> {
        self.0.back().copied()
    }

    /// Mean of the newest `count` points.
    #[must_use]
    pub fn mean(&self, count: usize) -> f32 {
        let taken = self.0.iter().rev().take(count);
        let n = taken.len().max(1);
        taken.sum::<f32>() / n as f32
    }

    /// All points, oldest first, as (index, value).
    pub fn points(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.0.iter().enumerate().map(|(i, v)| [i as f64, f64::from(*v)])
    }
}

/// All curves. Times in milliseconds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plots {
    /// Controllers, a tick, on all threads together.
    pub policy: Series,
    /// Physics, a tick.
    pub physics: Series,
    /// Drawing, a frame.
    pub draw: Series,
    /// Panels, a frame.
    pub ui: Series,
    /// Speed of the player, metres per second.
    pub speed: Series,
    /// Score of the discriminator while a skill runs, else 0.
    pub score: Series,
}

impl Plots {
    /// Adds the numbers of a tick.
    pub fn tick(&mut self, sim: &Simulation) {
        let times = sim.times();
        let policy = times.policy.as_secs_f32() * 1e3;
        self.policy.push(policy);
        // The controllers' time is that of all threads together.
        let waited = policy / sim.control_threads() as f32;
        self.physics.push((times.whole.as_secs_f32() * 1e3 - waited).max(0.0));
        self.speed.push(sim.player().speed());
        self.score.push(sim.player().report().skill.and_then(|s| s.score).unwrap_or(0.0));
    }
}
