//! The tour: the pad of a script, played in the window when there was no input for a while. Any input ends it.

use gamepad::Script;
use policy_core::GamepadState;

/// Seconds without any input after which the tour begins.
pub const IDLE_SECS: f32 = 45.0;
/// Longest step that counts, seconds: a window that was moved or asleep was not idle.
const LONGEST_STEP: f32 = 0.25;

/// The script of the tour.
const SCRIPT: &str = include_str!("../../../../assets/scripts/tour.ron");

/// Waits for its turn, and plays.
#[derive(Clone, Debug, Default)]
pub struct Tour {
    idle_secs: f32,
    playing: Option<(Script, f64)>,
}

impl Tour {
    /// Somebody did something: the tour ends, or waits anew.
    pub fn interrupt(&mut self) {
        *self = Self::default();
    }

    /// Lets `dt` seconds of the clock on the wall pass. The tour begins after [`IDLE_SECS`] of them in a row with
    /// `may_play`, and ends without.
    pub fn advance(&mut self, dt: f32, may_play: bool) {
        if !may_play {
            return self.interrupt();
        }
        self.idle_secs += dt.clamp(0.0, LONGEST_STEP);
        if self.playing.is_none() && self.idle_secs > IDLE_SECS {
            self.playing = Script::from_ron(SCRIPT).ok().map(|script| (script, 0.0));
        }
    }

    /// Lets a tick of `dt_secs` of the world pass. At its end the script begins anew.
    pub fn tick(&mut self, dt_secs: f32) {
        if let Some((script, at)) = &mut self.playing {
            *at += f64::from(dt_secs);
            if *at > script.duration() {
                *at = 0.0;
            }
        }
    }

    /// The pad of the script, while it plays.
    #[must_use]
    pub fn pad(&self) -> Option<GamepadState> {
        self.playing.as_ref().map(|(script, at)| script.state_at(*at))
    }

    /// True while it plays.
    #[must_use]
    pub fn is_playing(&self) -> bool {
        self.playing.is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tour that has waited for `secs` seconds.
    fn waited(secs: f32) -> Tour {
        let mut tour = Tour::default();
        (0..(secs * 10.0) as usize).for_each(|_| tour.advance(0.1, true));
        tour
    }

    #[test]
    fn it_begins_after_a_while_without_input_and_ends_with_the_first() {
        assert!(!waited(IDLE_SECS - 1.0).is_playing());
        let mut tour = waited(IDLE_SECS + 1.0);
        assert_eq!(tour.pad(), Some(GamepadState::default()));
        (0..150).for_each(|_| tour.tick(1.0 / 30.0));
        assert!(tour.pad().unwrap().left_stick[1] > 0.9, "after five seconds it walks");
        tour.interrupt();
        assert_eq!(tour.pad(), None);
        tour.advance(0.1, true);
        assert!(!tour.is_playing(), "it waits as long as before");
    }

    #[test]
    fn it_waits_while_it_may_not_play_and_a_stall_is_not_idle() {
        let mut tour = waited(IDLE_SECS - 1.0);
        tour.advance(3600.0, true);
        assert!(!tour.is_playing());
        tour.advance(0.1, false);
        tour.advance(2.0, true);
        assert!(!tour.is_playing());
    }

    #[test]
    fn it_plays_round_and_round() {
        let mut tour = waited(IDLE_SECS + 1.0);
        let duration = Script::from_ron(SCRIPT).unwrap().duration();
        (0..(duration * 30.0) as usize + 5).for_each(|_| tour.tick(1.0 / 30.0));
        assert!(tour.is_playing());
        assert_eq!(tour.pad(), Some(GamepadState::default()), "the first seconds are at rest");
    }
}
