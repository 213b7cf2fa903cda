//! Real time to whole ticks: fixed steps off the draw rate.

/// Most ticks in one frame: below real time the demo slows down rather than stalls.
const MOST_TICKS: u32 = 64;
/// Longest frame that counts, seconds: after a longer one (a moved window, a breakpoint) time is dropped.
const LONGEST_FRAME: f32 = 0.25;

/// Pause, speed and the time that no tick has used yet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock {
    /// Stands still.
    pub paused: bool,
    /// Of real time, 1/32 to 8.
    pub speed: f32,
    /// Ticks to run though paused.
    pub steps: u32,
    /// Length of a control tick, seconds.
    tick_secs: f32,
    /// Seconds that no tick has used yet.
    left: f32,
    /// Simulated over real seconds, smoothed.
    pub realtime_factor: f32,
}

impl Clock {
    /// A clock for ticks of `tick_secs` seconds.
    #[must_use]
    pub fn new(tick_secs: f32) -> Self {
        Self { paused: false, speed: 1.0, steps: 0, tick_secs, left: 0.0, realtime_factor: 0.0 }
    }

    /// Counts ticks of another length from now on.
    pub fn set_tick_secs(&mut self, tick_secs: f32) {
        (self.tick_secs, self.left) = (tick_secs, 0.0);
    }

    /// Speeds that panels offer.
    pub const SPEEDS: [f32; 9] = [1.0 / 32.0, 1.0 / 16.0, 0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0];

    /// Ticks to run now that `dt` seconds have passed.
    pub fn ticks_due(&mut self, dt: f32) -> u32 {
        let dt = if dt.is_finite() { dt.clamp(0.0, LONGEST_FRAME) } else { 0.0 };
        if self.paused {
            self.left = 0.0;
            std::mem::take(&mut self.steps).min(MOST_TICKS)
        } else {
            self.left += dt * self.speed;
            let ticks = ((self.left / self.tick_secs) as u32).min(MOST_TICKS);
            self.left = (self.left - ticks as f32 * self.tick_secs).min(self.tick_secs);
            ticks
        }
    }

    /// Notes how many ticks a frame of `dt` seconds has run, for [`Clock::realtime_factor`].
    pub fn ran(&mut self, ticks: u32, dt: f32) {
        if dt.is_finite() && dt > 0.0 {
            let now = ticks as f32 * self.tick_secs / dt;
            self.realtime_factor += (now - self.realtime_factor) * (dt * 2.0).min(1.0);
        }
    }

    /// Whether it stands still or runs at another speed than that of real time, in words; empty where neither is so.
    #[must_use]
    pub fn state(&self) -> String {
        match (self.paused, self.speed) {
            (true, _) => "paused".into(),
            (_, 1.0) => String::new(),
            (_, speed) => format!("speed {}", Self::speed_name(speed)),
        }
    }

    /// A speed in words: `1/4`, `2`.
    #[must_use]
    pub fn speed_name(speed: f32) -> String {
        if speed < 1.0 { format!("1/{:.0}", 1.0 / speed) } else { format!("{speed:.0}") }
    }

    /// Puts the picture so far into the tick, for pictures at times of their own.
    pub fn set_alpha(&mut self, alpha: f32) {
        self.left = alpha.clamp(0.0, 1.0) * self.tick_secs;
    }

    /// Share of a tick that has passed since the last one.
    #[must_use]
    pub fn alpha(&self) -> f32 {
        (self.left / self.tick_secs).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TICK_SECS: f32 = 1.0 / 30.0;

    #[test]
    fn ticks_keep_to_the_time_at_any_frame_rate() {
        for fps in [7.0, 30.0, 59.94, 144.0, 1000.0] {
            let mut clock = Clock::new(TICK_SECS);
            let frames = (4.0 * fps) as usize;
            let ticks: u32 = (0..frames).map(|_| clock.ticks_due(1.0 / fps)).sum();
            let due = frames as f32 / fps / TICK_SECS;
            assert!((ticks as f32 - due).abs() <= 1.5, "{fps} fps: {ticks} ticks, {due} due");
        }
    }

    #[test]
    fn its_state_is_told_where_it_is_not_the_usual_one() {
        let clock = Clock::new(TICK_SECS);
        assert_eq!(clock.state(), "");
        assert_eq!(Clock { speed: 0.25, ..clock }.state(), "speed 1/4");
        assert_eq!(Clock { speed: 2.0, ..clock }.state(), "speed 2");
        assert_eq!(Clock { paused: true, speed: 2.0, ..clock }.state(), "paused");
    }

    #[test]
    fn a_paused_clock_steps_only_when_asked() {
        let mut clock = Clock { paused: true, ..Clock::new(TICK_SECS) };
        assert_eq!(clock.ticks_due(1.0), 0);
        clock.steps = 1;
        assert_eq!((clock.ticks_due(0.01), clock.ticks_due(0.01)), (1, 0));
    }

    #[test]
    fn the_real_time_factor_counts_what_was_run_over_the_whole_frame() {
        let mut clock = Clock::new(TICK_SECS);
        for _ in 0..20 {
            // Half a second is longer than what counts for ticks.
            assert!(clock.ticks_due(0.5) <= 8);
            clock.ran(3, 0.5);
        }
        assert!((clock.realtime_factor - 0.2).abs() < 1e-3, "{}", clock.realtime_factor);
    }

    #[test]
    fn a_stall_does_not_make_an_avalanche() {
        let mut clock = Clock { speed: 8.0, ..Clock::new(TICK_SECS) };
        assert!(clock.ticks_due(1e6) <= MOST_TICKS && clock.ticks_due(f32::NAN) <= 1);
    }
}
