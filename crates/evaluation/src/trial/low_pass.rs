//! A low-pass filter for the velocity of the pelvis, which sways with every step.

use glam::Vec2;

use super::TICK_SECS;

/// Length of the window, seconds.
const WINDOW_SECS: f32 = 0.2;

/// Ticks in the window.
const WINDOW: usize = (WINDOW_SECS / TICK_SECS + 0.5) as usize;

/// Mean over the last 0.2 s of a signal that is sampled at the control rate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LowPass {
    values: [Vec2; WINDOW],
    next: usize,
}

impl LowPass {
    /// A filter that has seen nothing but `value`.
    #[must_use]
    pub fn at(value: Vec2) -> Self {
        Self { values: [value; WINDOW], next: 0 }
    }

    /// Takes the value of the next tick.
    pub fn tick(&mut self, value: Vec2) {
        self.values[self.next] = value;
        self.next = (self.next + 1) % WINDOW;
    }

    /// The mean.
    #[must_use]
    pub fn value(&self) -> Vec2 {
        self.values.iter().sum::<Vec2>() / WINDOW as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_through_after_the_window_and_half_through_after_half_of_it() {
        let mut filter = LowPass::at(Vec2::Y);
        (0..3).for_each(|_| filter.tick(Vec2::X));
        assert!((filter.value() - Vec2::new(0.5, 0.5)).length() < 1e-6, "{filter:?}");
        (0..3).for_each(|_| filter.tick(Vec2::X));
        assert!((filter.value() - Vec2::X).length() < 1e-6, "{filter:?}");
        assert_eq!(WINDOW, 6);
    }
}
