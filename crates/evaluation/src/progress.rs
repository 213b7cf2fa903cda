//! How far an evaluation has come, counted in seconds of one character's time.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

/// A progress bar with rate and time left, or none.
#[derive(Clone, Debug)]
pub struct Progress {
    bar: ProgressBar,
}

impl Progress {
    /// A bar on the terminal; without a terminal there is none.
    #[must_use]
    pub fn bar() -> Self {
        let style =
            "{elapsed:>4} {wide_bar} {human_pos}/{human_len} character-seconds {per_sec} {eta} left, {msg}";
        let style = ProgressStyle::with_template(style).unwrap_or_else(|_| ProgressStyle::default_bar());
        let bar = ProgressBar::new(0).with_style(style);
        bar.enable_steady_tick(Duration::from_millis(500));
        Self { bar }
    }

    /// No bar.
    #[must_use]
    pub fn hidden() -> Self {
        Self { bar: ProgressBar::hidden() }
    }

    /// Sets the seconds of the whole evaluation.
    pub(super) fn set_length(&self, secs: f32) {
        self.bar.set_length(secs as u64);
    }

    /// Begins a part at `secs` of the whole.
    pub(super) fn begin(&self, name: &'static str, secs: f32) {
        self.bar.set_position(secs as u64);
        self.bar.set_message(name);
    }

    /// Adds the seconds of a trial.
    pub(super) fn add(&self, secs: f32) {
        self.bar.inc(secs.round() as u64);
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
