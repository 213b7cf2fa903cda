//! Stretches of an episode in which a character acts by the mean alone, as in a game. What fails there is failed in a game
//! too, and learning goes on from where such a stretch leads.

use super::super::command::DT_SECS;
use super::super::config::EnvironmentConfig;
use crate::Rng;

/// Whether a character's actions have noise now, and for how long yet.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Noise {
    quiet: bool,
    ticks: u32,
}

impl Noise {
    /// At the start of an episode: quiet by the recipe's share of time, or certainly not, for one that is about what to do
    /// otherwise.
    pub(super) fn begin(config: &EnvironmentConfig, explores: bool, rng: &mut Rng) -> Self {
        if config.quiet == 0.0 {
            return Self::default();
        }
        let quiet = !explores && rng.chance(config.quiet);
        Self { quiet, ticks: ticks(config, quiet, rng) }
    }

    /// Moves on by a tick.
    pub(super) fn tick(&mut self, config: &EnvironmentConfig, rng: &mut Rng) {
        self.ticks = self.ticks.saturating_sub(1);
        if config.quiet > 0.0 && self.ticks == 0 {
            self.quiet = !self.quiet;
            self.ticks = ticks(config, self.quiet, rng);
        }
    }

    /// True in a stretch without noise.
    pub(super) fn is_quiet(self) -> bool {
        self.quiet
    }
}

/// Length of a stretch; those with noise are as much longer as their share of time is larger.
fn ticks(config: &EnvironmentConfig, quiet: bool, rng: &mut Rng) -> u32 {
    let [least, most] = config.quiet_secs;
    let factor = if quiet { 1.0 } else { (1.0 - config.quiet) / config.quiet };
    (rng.range(least, most) * factor / DT_SECS).max(1.0) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_share_of_quiet_ticks_is_the_recipes() {
        let mut rng = Rng::new(3, 0);
        for quiet in [0.0, 0.3, 0.6] {
            let config = EnvironmentConfig { quiet, quiet_secs: [0.5, 3.0], ..EnvironmentConfig::default() };
            let mut noise = Noise::begin(&config, false, &mut rng);
            let ticks = 200_000;
            let mut silent = 0;
            for _ in 0..ticks {
                silent += i32::from(noise.is_quiet());
                noise.tick(&config, &mut rng);
            }
            assert!((silent as f32 / ticks as f32 - quiet).abs() < 0.03, "{silent} of {ticks}, {quiet}");
        }
    }

    #[test]
    fn who_explores_begins_with_noise() {
        let mut rng = Rng::new(4, 0);
        let config = EnvironmentConfig { quiet: 0.9, ..EnvironmentConfig::default() };
        assert!((0..50).all(|_| !Noise::begin(&config, true, &mut rng).is_quiet()));
        assert!((0..50).any(|_| Noise::begin(&config, false, &mut rng).is_quiet()));
    }
}
