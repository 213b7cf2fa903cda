//! Control ticks at a fixed rate for games that draw at another.

/// Counts the control ticks that are due, whatever the frame rate.
///
/// ```
/// use policy_core::FixedRate;
/// let mut rate = FixedRate::new(30.0);
/// let ticks: u32 = (0..144).map(|_| rate.advance(1.0 / 144.0)).sum();
/// assert!((29..=30).contains(&ticks));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FixedRate {
    period_secs: f32,
    left_over_secs: f32,
}

/// Most ticks of one frame: a game that stalled does not catch up with a burst.
const MOST_TICKS: u32 = 4;

impl FixedRate {
    /// A rate in hertz, such as [`CharacterPack::control_hz`](crate::CharacterPack::control_hz).
    ///
    /// # Panics
    /// When the rate is not a finite number above 0.
    #[must_use]
    pub fn new(hz: f32) -> Self {
        assert!(hz.is_finite() && hz > 0.0, "a rate above 0, found {hz}");
        Self { period_secs: 1.0 / hz, left_over_secs: 0.0 }
    }

    /// Seconds of one tick: what [`Controller::tick`](crate::Controller::tick) takes.
    #[must_use]
    pub fn period_secs(&self) -> f32 {
        self.period_secs
    }

    /// Takes the seconds of a frame and returns the ticks that are due, at most 4. Time beyond these is dropped. A time
    /// that is negative or not finite counts as 0.
    pub fn advance(&mut self, frame_secs: f32) -> u32 {
        let frame = if frame_secs.is_finite() { frame_secs.max(0.0) } else { 0.0 };
        self.left_over_secs += frame;
        // A hair of slack, so that frames of exactly one period give one tick each.
        let due = (self.left_over_secs / self.period_secs + 1e-3) as u32;
        if due > MOST_TICKS {
            self.left_over_secs = 0.0;
            return MOST_TICKS;
        }
        self.left_over_secs = (self.left_over_secs - due as f32 * self.period_secs).max(0.0);
        due
    }

    /// How far the frame lies between the last two ticks, in [0, 1]: the weight of the newer pose when poses are
    /// interpolated.
    #[must_use]
    pub fn fraction(&self) -> f32 {
        (self.left_over_secs / self.period_secs).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_frame_rate_gives_the_ticks_of_the_rate() {
        for fps in [24.0, 30.0, 60.0, 64.0, 144.0, 1000.0] {
            let mut rate = FixedRate::new(30.0);
            let ticks: u32 = (0..10 * fps as u32).map(|_| rate.advance(1.0 / fps)).sum();
            assert!((298..=301).contains(&ticks), "{ticks} at {fps}");
            assert!((0.0..=1.0).contains(&rate.fraction()));
        }
    }

    #[test]
    fn a_stall_gives_no_burst_and_bad_times_nothing() {
        let mut rate = FixedRate::new(30.0);
        assert_eq!(rate.advance(5.0), 4);
        assert_eq!((rate.advance(0.0), rate.fraction()), (0, 0.0), "the rest of the stall is dropped");
        let kept = [4.0, 0.5, 0.5].map(|periods| rate.advance(periods * rate.period_secs()));
        assert_eq!(kept, [4, 0, 1], "less than a stall is kept");
        assert_eq!([f32::NAN, -1.0, f32::INFINITY].map(|secs| rate.advance(secs)), [0; 3]);
    }
}
