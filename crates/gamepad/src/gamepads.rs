//! All connected pads: hot-plug, each pad once, one of them active.
//!
//! Owns the back ends and one [`PadSession`] for each device. Everything except [`Gamepads::poll`] is pure, so that
//! tests can apply events.

mod pad;

use std::io::Write;
use std::time::Instant;

pub use pad::Pad;

use crate::backend::{BackendError, PadBackend};
use crate::device::{DeviceEvent, DeviceInfo, DeviceKey, Problem, Source};
use crate::pads::{Bus, MAX_OUTPUT_LEN, PadOutput};
use crate::recording::RecordingError;
use crate::{Button, PadReport, PadSession};

/// Every pad that is connected, through all back ends.
pub struct Gamepads {
    start: Instant,
    backends: Vec<Box<dyn PadBackend>>,
    /// Reused by every poll.
    events: Vec<(Instant, DeviceEvent)>,
    pads: Vec<Pad>,
    problems: Vec<(DeviceInfo, Problem)>,
    active: Option<DeviceKey>,
    pressed: Option<DeviceKey>,
    /// Recordings that ended because their pads were disconnected, until they are stopped.
    ended: Vec<(DeviceKey, Result<(), RecordingError>)>,
    now_secs: f64,
}

impl Gamepads {
    /// These back ends, without pads yet.
    #[must_use]
    pub fn new(backends: Vec<Box<dyn PadBackend>>) -> Self {
        Self {
            start: Instant::now(),
            backends,
            events: Vec::new(),
            pads: Vec::new(),
            problems: Vec::new(),
            active: None,
            pressed: None,
            ended: Vec::new(),
            now_secs: 0.0,
        }
    }

    /// Every back end of this build that starts, and the errors of the others.
    #[must_use]
    pub fn with_all_backends() -> (Self, Vec<BackendError>) {
        #[allow(unused_mut, reason = "a build without back ends")]
        let (mut backends, mut errors): (Vec<Box<dyn PadBackend>>, Vec<BackendError>) = Default::default();
        #[cfg(feature = "hidapi")]
        match crate::backend::HidBackend::start() {
            Ok(backend) => backends.push(Box::new(backend)),
            Err(error) => errors.push(error),
        }
        #[cfg(feature = "gilrs")]
        match crate::backend::GilrsBackend::start() {
            Ok(backend) => backends.push(Box::new(backend)),
            Err(error) => errors.push(error),
        }
        (Self::new(backends), errors)
    }

    /// Processes all events since the last call. Call it once per control tick. Never waits.
    pub fn poll(&mut self) {
        let mut events = std::mem::take(&mut self.events);
        for backend in &mut self.backends {
            backend.poll_into(&mut events);
        }
        for (time, event) in events.drain(..) {
            self.apply(time.saturating_duration_since(self.start).as_secs_f64(), event);
        }
        self.events = events;
        self.now_secs = self.now_secs.max(self.start.elapsed().as_secs_f64());
    }

    /// Processes one event that occurred `time_secs` after the start.
    pub fn apply(&mut self, time_secs: f64, event: DeviceEvent) {
        self.now_secs = self.now_secs.max(time_secs);
        let now_secs = self.now_secs;
        match event {
            DeviceEvent::Connected { device, descriptor } => self.connect(device, descriptor),
            DeviceEvent::Unusable { device, problem } => self.problems.push((device, problem)),
            DeviceEvent::Disconnected(key) => {
                let recording = self.pad_mut(key).and_then(|pad| pad.disconnect(now_secs));
                self.ended.extend(recording.map(|result| (key, result)));
                self.pads.retain(|pad| pad.device.key != key);
                self.problems.retain(|(device, _)| device.key != key);
            }
            DeviceEvent::Report(key, report) => self.with_pad(key, |pad| pad.report(&report, now_secs)),
            DeviceEvent::Feature(key, report) => self.with_pad(key, |pad| pad.feature(&report, now_secs)),
            DeviceEvent::State(key, state) => self.with_pad(key, |pad| pad.state(state, now_secs)),
        }
    }

    fn connect(&mut self, device: DeviceInfo, descriptor: Option<Vec<u8>>) {
        let session = match &descriptor {
            Some(descriptor) => PadSession::new(device.id, descriptor),
            None => Ok(PadSession::of_states()),
        };
        match session {
            Ok(session) => self.pads.push(Pad::new(device, descriptor, session)),
            Err(error) => self.problems.push((device, error.into())),
        }
    }

    /// Runs `act` on a pad. A pad whose controls leave neutral becomes the active one, and so does one on which another button goes
    /// down. One that lies with a trigger pulled does not become active again with every report.
    fn with_pad(&mut self, key: DeviceKey, act: impl FnOnce(&mut Pad)) {
        let now_secs = self.now_secs;
        let Some(index) = self.pads.iter().position(|pad| pad.device.key == key) else { return };
        act(&mut self.pads[index]);
        let (mut pressed, is_used) = self.pads[index].next_use(now_secs);
        if !is_used || !self.is_shown(index) {
            return;
        }
        self.active = Some(key);
        // A pad that lies on its trigger presses no button.
        pressed.set(Button::LeftTrigger, false);
        pressed.set(Button::RightTrigger, false);
        if !pressed.is_empty() {
            self.pressed = Some(key);
        }
    }

    /// The pads, each physical pad once.
    pub fn pads(&self) -> impl Iterator<Item = &Pad> {
        self.pads.iter().enumerate().filter(|(index, _)| self.is_shown(*index)).map(|(_, pad)| pad)
    }

    /// Devices that are ignored because the same pad is connected in another way.
    pub fn duplicates(&self) -> impl Iterator<Item = &Pad> {
        self.pads.iter().enumerate().filter(|(index, _)| !self.is_shown(*index)).map(|(_, pad)| pad)
    }

    /// Devices that look like pads but can't be read, with the reason.
    #[must_use]
    pub fn problems(&self) -> &[(DeviceInfo, Problem)] {
        &self.problems
    }

    /// The pad that was used last; the first one if none was used.
    #[must_use]
    pub fn active(&self) -> Option<&Pad> {
        let used = self.pads().find(|pad| Some(pad.device.key) == self.active);
        used.or_else(|| self.pads().next())
    }

    /// The pad on which a button went down last, other than a trigger; `None` before that.
    #[must_use]
    pub fn pressed(&self) -> Option<&Pad> {
        self.pads().find(|pad| Some(pad.device.key) == self.pressed)
    }

    /// Report of the active pad, neutral without a pad. This is what a game reads.
    #[must_use]
    pub fn report(&self) -> PadReport {
        self.active().map(|pad| self.report_of(pad)).unwrap_or_default()
    }

    /// The report of one pad, as of the last poll.
    #[must_use]
    pub fn report_of(&self, pad: &Pad) -> PadReport {
        pad.session.report_at(self.now_secs)
    }

    /// Seconds since the start, as of the last poll.
    #[must_use]
    pub fn now_secs(&self) -> f64 {
        self.now_secs
    }

    /// A pad by its key, to calibrate it or set its dead zones.
    pub fn pad_mut(&mut self, key: DeviceKey) -> Option<&mut Pad> {
        self.pads.iter_mut().find(|pad| pad.device.key == key)
    }

    /// Sets rumble and light of a pad. Returns false when it supports neither.
    pub fn set_output(&mut self, key: DeviceKey, output: &PadOutput) -> bool {
        let Some(pad) = self.pads.iter_mut().find(|pad| pad.device.key == key) else { return false };
        let mut report = [0; MAX_OUTPUT_LEN];
        let Some(len) = pad.encode_into(output, &mut report) else { return false };
        self.backends.iter_mut().any(|backend| backend.send(key, &report[..len]))
    }

    /// Starts to record a pad into `out`, until [`Gamepads::stop_recording`] or a disconnect. Replaces a running recording.
    ///
    /// # Errors
    /// [`RecordingError::Io`] when the header can't be written.
    pub fn record(&mut self, key: DeviceKey, out: Box<dyn Write + Send>) -> Result<bool, RecordingError> {
        let now_secs = self.now_secs;
        self.pad_mut(key).map_or(Ok(false), |pad| pad.record(out, now_secs).map(|()| true))
    }

    /// Ends the recording of a pad and flushes it; true when there was one. A recording ends by itself when its pad is disconnected;
    /// then this returns how it ended, once.
    ///
    /// # Errors
    /// [`RecordingError`] when the output fails or has failed before.
    pub fn stop_recording(&mut self, key: DeviceKey) -> Result<bool, RecordingError> {
        if let Some(pad) = self.pad_mut(key) {
            return pad.stop_recording();
        }
        match self.ended.iter().position(|(ended, _)| *ended == key) {
            Some(index) => self.ended.swap_remove(index).1.map(|()| true),
            None => Ok(false),
        }
    }

    /// False for a duplicate: a device with the serial number of another (a cable is preferred to Bluetooth), or a
    /// gilrs device where HID has the same kind of pad.
    fn is_shown(&self, index: usize) -> bool {
        let rank =
            |pad: &Pad| (pad.device.source == Source::Gilrs, pad.device.id.bus != Bus::Usb, pad.device.key);
        let pad = &self.pads[index];
        !self.pads.iter().any(|other| is_same_pad(&pad.device, &other.device) && rank(other) < rank(pad))
    }
}

fn is_same_pad(a: &DeviceInfo, b: &DeviceInfo) -> bool {
    let kind = |device: &DeviceInfo| (device.id.vendor, device.id.product);
    if a.key == b.key || kind(a) != kind(b) {
        return false;
    }
    match (a.source == b.source, &a.serial, &b.serial) {
        (false, ..) => true,
        (true, Some(first), Some(second)) => letters(first).eq(letters(second)),
        (true, ..) => false,
    }
}

/// A serial number without punctuation and case: spellings of Bluetooth addresses differ.
fn letters(serial: &str) -> impl Iterator<Item = char> {
    serial.chars().filter(char::is_ascii_alphanumeric).map(|c| c.to_ascii_lowercase())
}
