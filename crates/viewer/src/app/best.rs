//! The course of a shared world in the demo: its best time, and what is told of it.

use std::path::PathBuf;

use super::App;
use playground::RaceEvent;

use crate::best_time::BestTime;
use crate::files;
use crate::replays::Replaying;
use crate::sound::Sound;

/// From one bell to the next, seconds.
const BELLS_APART_SECS: f32 = 0.11;

/// The best time over the course, and where it is kept.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Best {
    time: Option<BestTime>,
    /// `None` when it is not kept.
    settings: Option<PathBuf>,
    /// True once the file was read.
    is_read: bool,
}

impl Best {
    /// Kept beside a settings file.
    #[must_use]
    pub fn beside(settings: PathBuf) -> Self {
        Self { settings: Some(settings), ..Self::default() }
    }

    /// The best time so far.
    #[must_use]
    pub fn time(&self) -> Option<BestTime> {
        self.time
    }
}

/// The bells of what happened on the course: their pitches.
fn bells(events: &[RaceEvent], is_best: bool) -> Option<&'static [f32]> {
    Some(match events.last()? {
        RaceEvent::Finished if is_best => &[1.0, 1.25, 1.5, 2.0],
        RaceEvent::Finished => &[1.5, 1.25, 1.0],
        RaceEvent::Started => &[1.0, 1.0],
        RaceEvent::Passed => &[1.0, 1.5],
    })
}

impl App {
    /// True while what happens on the course is the player's own doing: no tour, script or replay steers.
    pub(super) fn is_own_run(&self) -> bool {
        !self.tour.is_playing() && !self.is_scripted && !matches!(self.replaying, Replaying::Playing(_))
    }

    /// Takes what happened in a shared world during a tick: a new best time is kept at once, and what diverged is told. Only
    /// the player's own runs count.
    pub(super) fn follow_race(&mut self) {
        let tick_secs = self.sim.tick_secs();
        let Some(shared) = self.sim.shared_mut() else { return };
        let (events, put_right) = (shared.take_events(), shared.take_put_right());
        let run = BestTime { secs: shared.race().secs(tick_secs), falls: shared.race().falls() };
        let scene = shared.scene().name.clone();
        self.put_right += put_right.len();
        if let Some(last) = put_right.last() {
            self.toasts.error(last.clone());
        }
        let file = self.best.settings.as_deref().map(|settings| BestTime::file_beside(settings, &scene));
        if !std::mem::replace(&mut self.best.is_read, true)
            && let Some(path) = &file
        {
            match BestTime::load(path) {
                Ok(time) => self.best.time = time,
                // A better time replaces the file: what it holds is copied aside, or nothing is written.
                Err(error) => {
                    let (said, kept) = files::keep_unreadable(path, &error, "Best times");
                    self.toasts.error(said);
                    self.best.settings = self.best.settings.take().filter(|_| kept);
                }
            }
        }
        let file = file.filter(|_| self.best.settings.is_some());
        let is_best = self.is_own_run() && events.contains(&RaceEvent::Finished) && run.beats(self.best.time);
        if let Some(pitches) = bells(&events, is_best) {
            self.ear.add(Sound::bells(pitches, BELLS_APART_SECS));
        }
        if is_best {
            self.best.time = Some(run);
            if let Some(Err(error)) = file.map(|path| run.save(&path)) {
                self.toasts.error(error.to_string());
            }
        }
    }
}
