//! Plays a recording as a virtual pad.

use super::{PadEvent, Recording};
use crate::{NoGamepad, PadReport, PadSession};

/// A virtual pad: a recording and its playing position.
///
/// The report at a time depends only on the recording and that time, not on the steps to it.
#[derive(Clone, Debug)]
pub struct VirtualPad {
    recording: Recording,
    session: PadSession,
    next: usize,
    time_secs: f64,
}

impl VirtualPad {
    /// A pad at the start of `recording`.
    ///
    /// # Errors
    /// [`NoGamepad`] when the recorded pad is unknown and its descriptor describes no gamepad.
    pub fn new(recording: Recording) -> Result<Self, NoGamepad> {
        let session = Self::session(&recording)?;
        Ok(Self { recording, session, next: 0, time_secs: 0.0 })
    }

    fn session(recording: &Recording) -> Result<PadSession, NoGamepad> {
        let pad = recording.pad();
        match &pad.descriptor {
            Some(descriptor) => PadSession::new(pad.id, descriptor),
            None => Ok(PadSession::of_states()),
        }
    }

    /// The recording that is played.
    #[must_use]
    pub fn recording(&self) -> &Recording {
        &self.recording
    }

    /// True once every event has been played.
    #[must_use]
    pub fn is_over(&self) -> bool {
        self.next >= self.recording.len()
    }

    /// Plays to `time_secs` and returns the pad's report at that time. An earlier time changes nothing. Does not
    /// allocate.
    pub fn report_at(&mut self, time_secs: f64) -> PadReport {
        while let Some((event_secs, event)) = self.recording.event(self.next) {
            let due = event_secs <= time_secs;
            if !due {
                break;
            }
            match event {
                // The session counts what it refuses.
                PadEvent::Report(report) => drop(self.session.accept(report, event_secs)),
                PadEvent::Feature(report) => self.session.accept_feature(report),
                PadEvent::State(state) => self.session.accept_state(state, event_secs),
                PadEvent::Disconnected => self.session.disconnect(),
                PadEvent::Calibration(calibration) => self.session.set_calibration(calibration),
            }
            self.next += 1;
        }
        self.time_secs = self.time_secs.max(time_secs);
        self.session.report_at(self.time_secs)
    }

    /// Number of reports accepted and refused so far.
    #[must_use]
    pub fn counts(&self) -> (u64, u64) {
        self.session.counts()
    }
}
