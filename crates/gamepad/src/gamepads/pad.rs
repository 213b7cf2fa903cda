//! One connected pad: its device, its session, its output, its recording.

use std::io::Write;

use crate::calibration::Calibration;
use crate::device::DeviceInfo;
use crate::pads::{MAX_OUTPUT_LEN, Model, OutputEncoder, PadOutput};
use crate::recording::{PadEvent, RecordedPad, Recorder, RecordingError};
use crate::{Buttons, GamepadState, PadSession, ReportError};

/// Most set-up reports kept, for a recording that starts later.
const MOST_SET_UP: usize = 16;

/// One connected pad.
pub struct Pad {
    /// The device.
    pub device: DeviceInfo,
    /// Its state over time; calibrate it here.
    pub session: PadSession,
    descriptor: Option<Vec<u8>>,
    encoder: Option<OutputEncoder>,
    /// Feature reports, and replies with calibrations.
    start_up: Vec<(bool, Box<[u8]>)>,
    last_error: Option<ReportError>,
    /// After the last event.
    last_state: GamepadState,
    recorder: Option<(f64, Recorder<Box<dyn Write + Send>>)>,
    /// The calibration that the recording has; `None` while it leaves the measurement to whoever plays it.
    recorded: Option<Calibration>,
    recording_error: Option<RecordingError>,
}

impl Pad {
    pub(super) fn new(device: DeviceInfo, descriptor: Option<Vec<u8>>, session: PadSession) -> Self {
        let model = Model::of(device.id).filter(|_| descriptor.is_some());
        let encoder = model.map(|model| OutputEncoder::new(model, device.id.bus));
        Self {
            device,
            session,
            descriptor,
            encoder,
            start_up: Vec::new(),
            last_error: None,
            last_state: GamepadState::default(),
            recorder: None,
            recorded: None,
            recording_error: None,
        }
    }

    /// Why the last refused report was refused.
    #[must_use]
    pub fn last_error(&self) -> Option<ReportError> {
        self.last_error
    }

    /// True for pads that can rumble.
    #[must_use]
    pub fn has_output(&self) -> bool {
        self.encoder.is_some()
    }

    /// True for pads with a light bar.
    #[must_use]
    pub fn has_light(&self) -> bool {
        self.encoder.as_ref().is_some_and(OutputEncoder::has_light)
    }

    /// Ends the recording and flushes it; true when there was one.
    ///
    /// # Errors
    /// [`RecordingError`] when the output fails or has failed before.
    pub fn stop_recording(&mut self) -> Result<bool, RecordingError> {
        if let Some(error) = self.recording_error.take() {
            self.recorder = None;
            return Err(error);
        }
        match self.recorder.take() {
            Some((_, recorder)) => recorder.finish().map(|_| true),
            None => Ok(false),
        }
    }

    pub(super) fn record(&mut self, out: Box<dyn Write + Send>, now_secs: f64) -> Result<(), RecordingError> {
        let pad = RecordedPad {
            id: self.device.id,
            name: self.device.name.clone(),
            descriptor: self.descriptor.clone(),
        };
        let mut recorder = Recorder::new(out, &pad)?;
        for (feature, report) in &self.start_up {
            let event = if *feature { PadEvent::Feature(report) } else { PadEvent::Report(report) };
            recorder.record(0.0, event)?;
        }
        self.recorder = Some((now_secs, recorder));
        (self.recorded, self.recording_error) = (None, None);
        // While the first rest positions are measured there is no calibration yet.
        if !self.session.is_measuring() || *self.session.calibration() != Calibration::default() {
            self.write_calibration(now_secs);
        }
        self.recording_error.take().map_or(Ok(()), Err)
    }

    pub(super) fn report(&mut self, report: &[u8], now_secs: f64) {
        const FLASH_REPLY: u8 = 0x21;
        self.write(now_secs, PadEvent::Report(report));
        match self.session.accept(report, now_secs) {
            Ok(_) if Model::of(self.device.id) == Some(Model::SwitchPro) && report[0] == FLASH_REPLY => {
                self.keep(false, report);
            }
            Ok(_) => {}
            Err(error) => self.last_error = Some(error),
        }
        self.follow_calibration(now_secs);
    }

    pub(super) fn feature(&mut self, report: &[u8], now_secs: f64) {
        self.write(now_secs, PadEvent::Feature(report));
        self.session.accept_feature(report);
        self.keep(true, report);
    }

    pub(super) fn state(&mut self, state: GamepadState, now_secs: f64) {
        self.write(now_secs, PadEvent::State(state));
        self.session.accept_state(state, now_secs);
        self.follow_calibration(now_secs);
    }

    /// Buttons that went down in the last event, and whether the controls left neutral in it or one of the buttons did.
    pub(super) fn next_use(&mut self, now_secs: f64) -> (Buttons, bool) {
        let state = self.session.report_at(now_secs).state;
        let before = std::mem::replace(&mut self.last_state, state);
        let pressed = state.buttons.pressed_since(before.buttons);
        let neutral = GamepadState::default();
        (pressed, !pressed.is_empty() || (before == neutral && state != neutral))
    }

    /// Writes that the pad was pulled out and ends the recording; `None` when there is none.
    pub(super) fn disconnect(&mut self, now_secs: f64) -> Option<Result<(), RecordingError>> {
        self.write(now_secs, PadEvent::Disconnected);
        match self.stop_recording() {
            Ok(was_recorded) => was_recorded.then_some(Ok(())),
            Err(error) => Some(Err(error)),
        }
    }

    pub(super) fn encode_into(
        &mut self,
        output: &PadOutput,
        out: &mut [u8; MAX_OUTPUT_LEN],
    ) -> Option<usize> {
        self.encoder.as_mut().map(|encoder| encoder.encode_into(output, out))
    }

    fn keep(&mut self, feature: bool, report: &[u8]) {
        if self.start_up.len() < MOST_SET_UP {
            self.start_up.push((feature, report.into()));
        }
    }

    /// Writes the calibration once a measurement has ended or another was set.
    fn follow_calibration(&mut self, now_secs: f64) {
        let is_new = self.recorded.as_ref() != Some(self.session.calibration());
        if self.recorder.is_some() && is_new && !self.session.is_measuring() {
            self.write_calibration(now_secs);
        }
    }

    fn write_calibration(&mut self, now_secs: f64) {
        let calibration = *self.session.calibration();
        self.write(now_secs, PadEvent::Calibration(calibration));
        self.recorded = Some(calibration);
    }

    /// Ends a recording that fails; [`Pad::stop_recording`] returns the error.
    fn write(&mut self, now_secs: f64, event: PadEvent<'_>) {
        if let Some((start_secs, recorder)) = &mut self.recorder
            && let Err(error) = recorder.record(now_secs - *start_secs, event)
        {
            self.recording_error = Some(error);
            self.recorder = None;
        }
    }
}
