//! Characters that have settled in a gait, each at its own phase, to start any number of trials from.

use std::sync::Arc;

use physics::{Model, PhysicsCharacter, Snapshot};
use policy_core::{CharacterPack, Controller, ControllerConfig};
use random::Rng;

use super::{Gait, LowPass, Trial, ticks};

/// Longest way through the graph to a gait and the time in it, seconds.
const REACH_SECS: f32 = 20.0;

/// Seconds in the gait before a trial begins, and the range of a random time more, which gives the phase: several cycles of a crawl, the longest. Over
/// one and a half cycles some phases come twice as often as others, and turns to one side seem slower.
const SETTLE_SECS: [f32; 2] = [2.0, 8.0];

/// Largest angle from x at which a character sets off, radians.
const MOST_ANGLE: f32 = 0.2;

/// A character in a gait.
#[derive(Clone, Debug)]
pub struct Settled {
    /// The gait.
    pub gait: Gait,
    /// Seed of the trials that start here.
    pub seed: u64,
    snapshot: Snapshot,
    controller: Controller,
    velocity: LowPass,
}

impl Settled {
    /// Length of the way to a gait, seconds, by rule of thumb.
    pub const NOMINAL_SECS: f32 = SETTLE_SECS[0] + 0.5 * SETTLE_SECS[1] + 3.0;

    /// Lets a character settle in a gait, at a phase that is drawn from the seed. `None` when it falls on the way.
    #[must_use]
    pub fn one(
        model: &Model,
        pack: &Arc<CharacterPack>,
        config: ControllerConfig,
        gait: &Gait,
        seed: u64,
    ) -> Option<Settled> {
        let mut rng = Rng::new(seed, 23);
        let mut trial = Trial::new(model, pack, config, gait);
        trial.place(glam::Vec2::ZERO, rng.range(-MOST_ANGLE, MOST_ANGLE));
        let [least, more] = SETTLE_SECS;
        let mut left = ticks(least + rng.range(0.0, more));
        for _ in 0..ticks(REACH_SECS) {
            if !trial.tick() || trial.is_down() {
                return None;
            }
            left -= u32::from(trial.has_arrived());
            if left == 0 {
                break;
            }
        }
        let snapshot = trial.character.save();
        let (controller, velocity) = (trial.controller, trial.velocity);
        Some(Settled { gait: gait.clone(), seed, snapshot, controller, velocity })
    }

    /// A trial that goes on from here.
    ///
    /// # Panics
    /// When `model` is of another kind of character.
    #[must_use]
    pub fn resume(&self, model: &Model) -> Trial {
        let pack = self.controller.pack().clone();
        let mut trial = Trial::new(model, &pack, *self.controller.config(), &self.gait);
        trial.character.restore(&self.snapshot).expect("a snapshot of the same character");
        trial.controller = self.controller.clone();
        trial.character.sense_into(&mut trial.state);
        trial.velocity = self.velocity;
        trial
    }
}
