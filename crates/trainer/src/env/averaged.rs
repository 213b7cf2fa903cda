//! The velocity of a character over a few seconds. Some gaits sway: a crawl heads 50 degrees to one side and then to the other.
//! Paid for the velocity of each tick, a character gives up the sway of its clip; paid for the average, it keeps the sway and
//! goes the right way.

use glam::Vec2;

use super::command::DT_SECS;

/// Exponential average of a velocity, metres per second. It begins as the plain mean of what an episode has seen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct AveragedVelocity {
    value: Vec2,
    ticks: u32,
}

impl AveragedVelocity {
    /// Takes the velocity of a tick and returns the average over about the last `secs`; the velocity itself where `secs` is 0.
    pub(super) fn tick(&mut self, velocity: Vec2, secs: f32) -> Vec2 {
        self.ticks = self.ticks.saturating_add(1);
        let share = (DT_SECS / secs).max(1.0 / self.ticks as f32).min(1.0);
        self.value = self.value.lerp(velocity, share);
        self.value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_time_leaves_each_velocity_as_it_is() {
        let mut averaged = AveragedVelocity::default();
        for velocity in [Vec2::X, Vec2::Y, Vec2::ZERO, Vec2::new(-3.0, 0.5)] {
            assert_eq!(averaged.tick(velocity, 0.0), velocity);
        }
    }

    #[test]
    fn a_sway_goes_and_a_drift_stays() {
        let mut averaged = AveragedVelocity::default();
        let at = |tick: u32| {
            Vec2::new(0.3, 0.1 + 0.3 * (tick as f32 * DT_SECS * std::f32::consts::TAU / 2.0).sin())
        };
        let most = (0..300).map(|tick| averaged.tick(at(tick), 2.0).y).skip(150).map(|y| (y - 0.1).abs());
        assert!(most.fold(0.0, f32::max) < 0.06);
        assert!((averaged.value.x - 0.3).abs() < 1e-4);
    }

    #[test]
    fn a_new_velocity_is_the_average_after_a_few_times_as_long() {
        let mut averaged = AveragedVelocity::default();
        (0..100).for_each(|_| _ = averaged.tick(Vec2::X, 1.0));
        let after = |secs: f32| {
            let mut averaged = averaged;
            (0..(secs / DT_SECS) as u32).for_each(|_| _ = averaged.tick(Vec2::Y, 1.0));
            averaged.value.y
        };
        assert!((0.55..0.7).contains(&after(1.0)), "{}", after(1.0));
        assert!(after(4.0) > 0.97);
    }
}
