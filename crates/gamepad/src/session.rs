//! One pad over time: its parser, its calibration, and its state while it is silent or disconnected.
//!
//! Pure: reports and times in, [`PadReport`] out; the same reports at the same times give the same states.

use crate::calibration::{Calibration, DeadZones, NotAtRest, RestCalibrator};
use crate::pads::{PadId, Parser};
use crate::{GamepadState, NoGamepad, PadInput, PadReport, ReportError, Update};

/// How long a pad that reports continuously may be silent before it counts as disconnected, in seconds. Pads whose
/// reports include motion sensors report continuously, and so do those that are observed to. Others may report
/// changes only.
pub const SILENCE_SECS: f64 = 0.25;
/// How long rest positions are measured after connecting, in seconds.
pub const CALIBRATION_SECS: f64 = 0.5;
/// This many reports in a row without a change, at most [`STREAM_GAP_SECS`] apart, show that a pad reports
/// continuously.
const STREAM_REPORTS: u32 = 50;
const STREAM_GAP_SECS: f64 = 0.05;

/// Source of a session's raw states.
#[derive(Clone, Debug)]
enum Source {
    Reports(Parser),
    States,
}

/// One connected pad.
#[derive(Clone, Debug)]
pub struct PadSession {
    source: Source,
    seen_to_stream: bool,
    unchanged: u32,
    input: PadInput,
    present: bool,
    last_secs: f64,
    /// As requested; those of the calibration may be wider.
    zones: DeadZones,
    calibration: Calibration,
    measuring: Option<(f64, RestCalibrator)>,
    outcome: Option<Result<(), NotAtRest>>,
    /// The last accepted measurement, to apply other dead zones to it.
    measured: Option<RestCalibrator>,
    /// The calibration was measured or set: connecting again does not measure.
    calibrated: bool,
    refused: u64,
    accepted: u64,
}

impl PadSession {
    /// A session for a pad that sends HID reports, from its ids and report descriptor.
    ///
    /// # Errors
    /// [`NoGamepad`] when the pad is unknown and its descriptor describes no gamepad.
    pub fn new(id: PadId, descriptor: &[u8]) -> Result<Self, NoGamepad> {
        Ok(Self::with_source(Source::Reports(Parser::new(id, descriptor)?)))
    }

    /// A session for a pad whose raw states another library reads.
    #[must_use]
    pub fn of_states() -> Self {
        Self::with_source(Source::States)
    }

    fn with_source(source: Source) -> Self {
        Self {
            source,
            seen_to_stream: false,
            unchanged: 0,
            input: PadInput::default(),
            present: false,
            last_secs: f64::NEG_INFINITY,
            zones: DeadZones::default(),
            calibration: Calibration::default(),
            measuring: None,
            outcome: None,
            measured: None,
            calibrated: false,
            refused: 0,
            accepted: 0,
        }
    }

    /// Processes one input report that arrived at `time_secs`. Does not allocate.
    ///
    /// # Errors
    /// [`ReportError`] for a report that is refused; the state is unchanged.
    pub fn accept(&mut self, report: &[u8], time_secs: f64) -> Result<Update, ReportError> {
        let Source::Reports(parser) = &mut self.source else {
            return Ok(Update::Nothing);
        };
        let before = self.input.raw;
        match parser.parse_into(report, &mut self.input) {
            Ok(Update::Absent) => {
                self.disconnect();
                Ok(Update::Absent)
            }
            Ok(update) => {
                self.observe(before, update, time_secs);
                Ok(update)
            }
            Err(error) => {
                self.refused += 1;
                Err(error)
            }
        }
    }

    /// Processes one raw state that arrived at `time_secs`.
    pub fn accept_state(&mut self, raw: GamepadState, time_secs: f64) {
        let before = std::mem::replace(&mut self.input.raw, raw);
        self.observe(before, Update::Controls, time_secs);
    }

    /// Processes a feature report requested at start-up.
    pub fn accept_feature(&mut self, report: &[u8]) {
        if let Source::Reports(parser) = &mut self.source {
            parser.accept_feature(report);
        }
    }

    /// Marks the pad as disconnected: neutral at once, until the next report.
    pub fn disconnect(&mut self) {
        self.input = PadInput::default();
        self.present = false;
        self.measuring = None;
    }

    /// Report of the pad at `time_secs`: neutral while it is disconnected or silent.
    #[must_use]
    pub fn report_at(&self, time_secs: f64) -> PadReport {
        if !self.is_present_at(time_secs) {
            return PadReport::default();
        }
        PadReport { state: self.calibration.state(&self.input.raw), input: self.input }
    }

    /// True unless the pad is disconnected, or silent although it reported continuously.
    #[must_use]
    pub fn is_present_at(&self, time_secs: f64) -> bool {
        let streams = self.seen_to_stream || self.input.motion.is_some();
        let silent = streams && time_secs - self.last_secs > SILENCE_SECS;
        self.present && !silent
    }

    /// Starts to measure rest positions, as after connecting; takes [`CALIBRATION_SECS`].
    pub fn calibrate(&mut self, time_secs: f64) {
        self.measuring = Some((time_secs, RestCalibrator::default()));
    }

    /// Rest positions and dead zones in use.
    #[must_use]
    pub fn calibration(&self) -> &Calibration {
        &self.calibration
    }

    /// Sets the dead zones and keeps the rest positions. The zone in use stays wider where a control moves more at rest
    /// than its zone allows.
    pub fn set_dead_zones(&mut self, zones: DeadZones) {
        self.zones = zones;
        let measured = self.measured.as_ref().and_then(|measured| measured.finish(zones).ok());
        self.calibration = measured.unwrap_or(Calibration { zones, ..self.calibration });
    }

    /// Sets rest positions and dead zones exactly, and ends a measurement.
    pub fn set_calibration(&mut self, calibration: Calibration) {
        self.zones = calibration.zones;
        self.calibration = calibration;
        self.measured = None;
        self.calibrated = true;
        self.measuring = None;
    }

    /// True while rest positions are measured.
    #[must_use]
    pub fn is_measuring(&self) -> bool {
        self.measuring.is_some()
    }

    /// Result of the last measurement; `None` before the first one ends.
    #[must_use]
    pub fn calibration_outcome(&self) -> Option<Result<(), NotAtRest>> {
        self.outcome
    }

    /// Number of reports accepted and refused.
    #[must_use]
    pub fn counts(&self) -> (u64, u64) {
        (self.accepted, self.refused)
    }

    fn observe(&mut self, before: GamepadState, update: Update, time_secs: f64) {
        self.accepted += 1;
        if update == Update::Controls {
            if !self.present && !self.calibrated {
                self.calibrate(time_secs);
            }
            self.present = true;
            self.measure(time_secs);
        }
        let steady = before == self.input.raw && time_secs - self.last_secs <= STREAM_GAP_SECS;
        self.unchanged = if steady { self.unchanged.saturating_add(1) } else { 0 };
        self.seen_to_stream |= self.unchanged >= STREAM_REPORTS && matches!(self.source, Source::Reports(_));
        self.last_secs = time_secs;
    }

    fn measure(&mut self, time_secs: f64) {
        let Some((start_secs, calibrator)) = &mut self.measuring else { return };
        calibrator.observe(&self.input.raw);
        if time_secs - *start_secs < CALIBRATION_SECS {
            return;
        }
        let outcome = calibrator.finish(self.zones);
        if let Ok(calibration) = outcome {
            self.calibration = calibration;
            self.calibrated = true;
            self.measured = Some(calibrator.clone());
        }
        self.outcome = Some(outcome.map(|_| ()));
        self.measuring = None;
    }
}
