//! The course: checkpoints in order, a clock, falls. Plain data and one pure function of a tick.

use glam::Vec2;

use super::Checkpoint;

/// Where a player is on the course.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RaceState {
    /// Before the first checkpoint: the clock stands.
    Waiting,
    /// Between the first and the last.
    Running,
    /// Past the last: the clock stands until the first is left behind again.
    Finished,
}

/// What a tick brought.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RaceEvent {
    /// The first checkpoint: the clock runs.
    Started,
    /// Another one.
    Passed,
    /// The last one.
    Finished,
}

/// One player's run over the course.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Race {
    state: RaceState,
    next: usize,
    ticks: u32,
    falls: u32,
    was_down: bool,
}

impl Default for Race {
    fn default() -> Self {
        Self { state: RaceState::Waiting, next: 0, ticks: 0, falls: 0, was_down: false }
    }
}

impl Race {
    /// Where it is.
    #[must_use]
    pub fn state(&self) -> RaceState {
        self.state
    }

    /// Index of the checkpoint that comes next; 0 when the run has ended.
    #[must_use]
    pub fn next(&self) -> usize {
        self.next
    }

    /// Time on the clock, seconds, for ticks of `tick_secs`.
    #[must_use]
    pub fn secs(&self, tick_secs: f32) -> f32 {
        self.ticks as f32 * tick_secs
    }

    /// Falls since the clock started.
    #[must_use]
    pub fn falls(&self) -> u32 {
        self.falls
    }

    /// One tick of a player that is at a point and down or not. Passing the first checkpoint starts a run, also while
    /// one has ended; the next ones count in their order only.
    pub fn tick(&mut self, checkpoints: &[Checkpoint], at: Vec2, down: bool) -> Option<RaceEvent> {
        let was_down = std::mem::replace(&mut self.was_down, down);
        let fell = down && !was_down;
        if self.state == RaceState::Running {
            self.ticks = self.ticks.saturating_add(1);
            self.falls += u32::from(fell);
        }
        let reached = checkpoints.get(self.next).is_some_and(|c| c.at.distance(at) <= c.radius);
        if !reached {
            return None;
        }
        let event = match (self.next, self.next + 1 == checkpoints.len()) {
            (0, _) => RaceEvent::Started,
            (_, true) => RaceEvent::Finished,
            _ => RaceEvent::Passed,
        };
        match event {
            RaceEvent::Started => {
                *self = Self { state: RaceState::Running, next: 1, was_down: down, ..Self::default() };
            }
            RaceEvent::Passed => self.next += 1,
            RaceEvent::Finished => (self.state, self.next) = (RaceState::Finished, 0),
        }
        Some(event)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn checkpoints() -> [Checkpoint; 3] {
        [0.0, 10.0, 20.0].map(|x| Checkpoint { at: Vec2::new(x, 0.0), radius: 1.0 })
    }

    /// Walks along x to `to`, half a metre a tick; returns the events.
    fn walk(race: &mut Race, from: f32, to: f32) -> Vec<RaceEvent> {
        let steps = ((to - from).abs() / 0.5) as i32;
        let at = |step: i32| Vec2::new(from + (to - from).signum() * 0.5 * step as f32, 0.2);
        (1..=steps).filter_map(|step| race.tick(&checkpoints(), at(step), false)).collect()
    }

    #[test]
    fn checkpoints_count_in_their_order_and_the_clock_runs_between_the_first_and_the_last() {
        let mut race = Race::default();
        assert_eq!(walk(&mut race, 30.0, 8.0), [], "the last ones first are no start");
        assert_eq!((race.state(), race.secs(0.1)), (RaceState::Waiting, 0.0));
        use RaceEvent::{Finished, Passed, Started};
        assert_eq!(walk(&mut race, -5.0, 30.0), [Started, Passed, Finished]);
        assert_eq!((race.state(), race.next()), (RaceState::Finished, 0));
        // From one metre before the first to one metre before the last, half a metre a tick.
        assert!((race.secs(0.1) - 4.0).abs() < 0.11, "{}", race.secs(0.1));
        let stopped = race.secs(0.1);
        walk(&mut race, 30.0, 5.0);
        assert_eq!(race.secs(0.1), stopped, "the clock stands");
    }

    #[test]
    fn a_checkpoint_that_is_left_out_stops_the_count() {
        let mut race = Race::default();
        walk(&mut race, -5.0, 5.0);
        let around = |x: f32| Vec2::new(x, 6.0);
        for step in 0..40 {
            assert_eq!(race.tick(&checkpoints(), around(5.0 + 0.5 * step as f32), false), None);
        }
        assert_eq!(race.tick(&checkpoints(), Vec2::new(20.0, 0.0), false), None);
        assert_eq!((race.state(), race.next()), (RaceState::Running, 1));
    }

    #[test]
    fn each_fall_counts_once_and_only_on_the_course() {
        let mut race = Race::default();
        let lie = |race: &mut Race, x: f32| {
            for down in [true, true, true, false] {
                race.tick(&checkpoints(), Vec2::new(x, 0.0), down);
            }
        };
        lie(&mut race, -5.0);
        walk(&mut race, -5.0, 5.0);
        assert_eq!(race.falls(), 0);
        lie(&mut race, 5.0);
        lie(&mut race, 6.0);
        assert_eq!(race.falls(), 2);
        walk(&mut race, 6.0, 30.0);
        lie(&mut race, 30.0);
        assert_eq!((race.state(), race.falls()), (RaceState::Finished, 2));
    }

    #[test]
    fn a_second_run_begins_from_zero() {
        let mut race = Race::default();
        walk(&mut race, -5.0, 30.0);
        assert_eq!(walk(&mut race, 30.0, -0.5), [RaceEvent::Started]);
        assert_eq!((race.state(), race.next()), (RaceState::Running, 1));
        assert!(race.secs(0.1) < 0.35, "{}", race.secs(0.1));
    }
}
