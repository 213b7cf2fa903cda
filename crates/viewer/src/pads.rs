//! Reads gamepads for the demo: the active one, and what could not be read, in words.

use gamepad::Gamepads;

use crate::app::PadView;

/// All pads and their back ends.
pub struct Pads {
    pads: Gamepads,
    complaints: Vec<String>,
}

impl std::fmt::Debug for Pads {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Pads").field("complaints", &self.complaints).finish_non_exhaustive()
    }
}

impl Pads {
    /// Starts every back end that there is.
    #[must_use]
    pub fn start() -> Self {
        let (pads, errors) = Gamepads::with_all_backends();
        Self { pads, complaints: errors.iter().map(ToString::to_string).collect() }
    }

    /// Reads the pads. Without one the state is neutral.
    pub fn poll(&mut self, view: &mut PadView) {
        self.pads.poll();
        let report = self.pads.report();
        let active = self.pads.active();
        view.name = active.map(|pad| format!("{} through {:?}", pad.device.name, pad.device.source));
        (view.raw, view.state) = (report.input.raw, report.state);
        view.problems.clear();
        view.problems.extend(self.complaints.iter().cloned());
        let unread = self.pads.problems().iter();
        view.problems.extend(unread.map(|(device, problem)| format!("{}: {problem}", device.name)));
        if let Some(error) = active.and_then(gamepad::Pad::last_error) {
            view.problems.push(format!("not understood: {error}"));
        }
    }
}
