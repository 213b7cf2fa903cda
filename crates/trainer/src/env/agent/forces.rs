//! Forces on a character: pushes from outside, and what presses on its feet.

use glam::Vec2;
use policy_core::Body;

use super::super::command::DT_SECS;
use super::super::config::EnvironmentConfig;
use super::super::reward::{RewardTerms, slide_mps};
use super::Agent;

/// Length of a push, seconds.
pub const PUSH_SECS: f32 = 0.2;

/// Metres per square second.
const GRAVITY: f32 = 9.81;

impl Agent {
    /// Now and then a push of 0.2 s on the pelvis, in a random horizontal direction.
    pub(super) fn push(&mut self, config: &EnvironmentConfig) {
        if config.push_secs > 0.0 && self.rng.chance(DT_SECS / config.push_secs) {
            let force = Vec2::from_angle(self.rng.angle()) * self.rng.uniform() * config.push_newton;
            self.character
                .push(Body::Pelvis, force.extend(0.0), PUSH_SECS)
                .expect("the recipe's force was checked");
        }
    }

    /// With how fast its feet slide.
    pub(super) fn with_slide(&self, terms: RewardTerms) -> RewardTerms {
        let weight = self.character.model().mass_kg() as f32 * GRAVITY;
        RewardTerms { slide_mps: slide_mps(&self.state, self.character.contacts(), weight), ..terms }
    }
}
