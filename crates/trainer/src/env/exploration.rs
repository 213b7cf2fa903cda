//! Deterministic intervals: stretches of an episode in which a character acts by the policy's mean, as in a game. What
//! fails there fails in a game too. Learning continues from the states that such a stretch leads to.

use random::Rng;
use serde::{Deserialize, Serialize};

use super::command::DT_SECS;

/// When actions have noise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ExplorationConfig {
    /// Share of the time in which a character acts by the policy's mean. Policies learn from the rest, discriminators and
    /// critic from all of it.
    pub deterministic_share: f32,
    /// Seconds of such an interval, least and most.
    pub deterministic_secs: [f32; 2],
}

impl Default for ExplorationConfig {
    fn default() -> Self {
        Self { deterministic_share: 0.0, deterministic_secs: [0.5, 3.0] }
    }
}

/// Whether a character's actions have noise now, and for how many ticks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Exploration {
    deterministic: bool,
    ticks: u32,
}

impl Exploration {
    /// At the start of an episode. One that starts before a failure begins with noise: it is there to find another way.
    pub(super) fn begin(config: &ExplorationConfig, before_failure: bool, rng: &mut Rng) -> Self {
        if config.deterministic_share == 0.0 {
            return Self::default();
        }
        let deterministic = !before_failure && rng.chance(config.deterministic_share);
        Self { deterministic, ticks: ticks(config, deterministic, rng) }
    }

    /// Advances by a tick.
    pub(super) fn tick(&mut self, config: &ExplorationConfig, rng: &mut Rng) {
        self.ticks = self.ticks.saturating_sub(1);
        if config.deterministic_share > 0.0 && self.ticks == 0 {
            self.deterministic = !self.deterministic;
            self.ticks = ticks(config, self.deterministic, rng);
        }
    }

    /// True in a deterministic interval.
    pub(super) fn is_deterministic(self) -> bool {
        self.deterministic
    }
}

/// Length of an interval. Those with noise are longer in the ratio of the shares.
fn ticks(config: &ExplorationConfig, deterministic: bool, rng: &mut Rng) -> u32 {
    let [least, most] = config.deterministic_secs;
    let share = config.deterministic_share;
    let factor = if deterministic { 1.0 } else { (1.0 - share) / share };
    (rng.range(least, most) * factor / DT_SECS).max(1.0) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_share_of_deterministic_ticks_is_the_recipes() {
        let mut rng = Rng::new(3, 0);
        for share in [0.0, 0.3, 0.6] {
            let config = ExplorationConfig { deterministic_share: share, ..ExplorationConfig::default() };
            let mut exploration = Exploration::begin(&config, false, &mut rng);
            let ticks = 200_000;
            let mut deterministic = 0;
            for _ in 0..ticks {
                deterministic += i32::from(exploration.is_deterministic());
                exploration.tick(&config, &mut rng);
            }
            let found = deterministic as f32 / ticks as f32;
            assert!((found - share).abs() < 0.03, "{found}, {share}");
        }
    }

    #[test]
    fn an_episode_that_starts_before_a_failure_begins_with_noise() {
        let mut rng = Rng::new(4, 0);
        let config = ExplorationConfig { deterministic_share: 0.9, ..ExplorationConfig::default() };
        assert!((0..50).all(|_| !Exploration::begin(&config, true, &mut rng).is_deterministic()));
        assert!((0..50).any(|_| Exploration::begin(&config, false, &mut rng).is_deterministic()));
    }
}
