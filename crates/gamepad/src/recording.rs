//! Recordings of one pad: its raw reports with their times.
//!
//! A recording holds raw reports, not states, so a better parser gives a better replay.
//! The format is specified in `docs/pad-recording.md`.

mod error;
mod plain;
mod player;
mod recorder;

use std::io::Read;
use std::path::Path;

pub use error::RecordingError;
pub use player::VirtualPad;
pub use recorder::Recorder;

use crate::GamepadState;
use crate::calibration::Calibration;
use crate::files::open_regular;
use crate::pads::{Bus, PadId};

/// Largest recording accepted, in bytes: many hours of input.
pub const MAX_RECORDING_BYTES: usize = 64 << 20;
/// Longest report in a recording, in bytes.
pub const MAX_RECORDED_REPORT: usize = 4096;
/// Latest time in a recording, in microseconds (one day).
pub const MAX_RECORDING_MICROS: u64 = 86_400_000_000;

const MAGIC: [u8; 8] = *b"PSPADREC";
const VERSION: u16 = 1;
const HEADER_LEN: usize = 20;
const RECORD_LEN: usize = 12;
const MAX_NAME: usize = 256;

/// The pad that was recorded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordedPad {
    /// Which kind of pad it is.
    pub id: PadId,
    /// Its name, for people; at most 256 bytes are kept.
    pub name: String,
    /// Its HID report descriptor; may be empty for known pads. `None`: not read through HID, its events are states.
    pub descriptor: Option<Vec<u8>>,
}

/// One event of the pad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PadEvent<'a> {
    /// An input report.
    Report(&'a [u8]),
    /// A feature report requested at start-up.
    Feature(&'a [u8]),
    /// A raw state, from a pad that is not read through HID.
    State(GamepadState),
    /// The pad was pulled out.
    Disconnected,
    /// The pad's calibration was set to this.
    Calibration(Calibration),
}

/// A whole recording, checked.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    pad: RecordedPad,
    /// Time in microseconds and the event's place in `bytes`.
    events: Vec<(u64, Kind, std::ops::Range<usize>)>,
    bytes: Vec<u8>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Report,
    Feature,
    State,
    Disconnected,
    Calibration,
}

impl Kind {
    fn of(byte: u8) -> Option<Self> {
        [Self::Report, Self::Feature, Self::State, Self::Disconnected, Self::Calibration]
            .get(usize::from(byte))
            .copied()
    }
}

impl Recording {
    /// Reads and checks a whole recording.
    ///
    /// # Errors
    /// [`RecordingError`] with the offset of the error.
    pub fn from_bytes(bytes: Vec<u8>) -> Result<Self, RecordingError> {
        if bytes.len() > MAX_RECORDING_BYTES {
            return Err(RecordingError::TooLong { found: bytes.len() });
        }
        let (pad, mut at) = read_header(&bytes)?;
        let mut events = Vec::new();
        let mut last = 0;
        while at < bytes.len() {
            let (micros, kind, body, end) = read_record(&bytes, at, pad.descriptor.is_some())?;
            if micros < last || micros > MAX_RECORDING_MICROS {
                return Err(RecordingError::Time { offset: at, previous: last, found: micros });
            }
            last = micros;
            events.push((micros, kind, body));
            at = end;
        }
        Ok(Self { pad, events, bytes })
    }

    /// Reads a recording from a file.
    ///
    /// # Errors
    /// [`RecordingError::InFile`] with the file and the error.
    pub fn load(path: &Path) -> Result<Self, RecordingError> {
        let in_file = |cause| RecordingError::InFile { file: path.to_owned(), cause: Box::new(cause) };
        let mut bytes = Vec::new();
        open_regular(path)
            .and_then(|file| file.take(MAX_RECORDING_BYTES as u64 + 1).read_to_end(&mut bytes))
            .map_err(|error| in_file(error.into()))?;
        Self::from_bytes(bytes).map_err(in_file)
    }

    /// The pad that was recorded.
    #[must_use]
    pub fn pad(&self) -> &RecordedPad {
        &self.pad
    }

    /// Number of events.
    #[must_use]
    pub fn len(&self) -> usize {
        self.events.len()
    }

    /// True without any event.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.events.is_empty()
    }

    /// Time of the last event in seconds.
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.events.last().map_or(0.0, |event| seconds(event.0))
    }

    /// The event with this index and its time in seconds.
    #[must_use]
    pub fn event(&self, index: usize) -> Option<(f64, PadEvent<'_>)> {
        let (micros, kind, body) = self.events.get(index)?;
        let bytes = &self.bytes[body.clone()];
        let event = match kind {
            Kind::Report => PadEvent::Report(bytes),
            Kind::Feature => PadEvent::Feature(bytes),
            Kind::State => PadEvent::State(plain::decode_state(bytes)?),
            Kind::Disconnected => PadEvent::Disconnected,
            Kind::Calibration => PadEvent::Calibration(plain::decode_calibration(bytes)?),
        };
        Some((seconds(*micros), event))
    }
}

fn seconds(micros: u64) -> f64 {
    micros as f64 / 1e6
}

fn u16_of(bytes: &[u8]) -> u16 {
    // Callers pass the rest of a slice of HEADER_LEN or RECORD_LEN, at two bytes before its end or earlier.
    u16::from_le_bytes([bytes[0], bytes[1]])
}

/// `len` bytes from `at`, or an error with the offset.
fn slice(bytes: &[u8], at: usize, len: usize) -> Result<&[u8], RecordingError> {
    bytes.get(at..at + len).ok_or(RecordingError::Truncated {
        offset: at,
        expected: len,
        found: bytes.len().saturating_sub(at),
    })
}

/// Checks the CRC32 that follows `start..end`; returns the offset after it.
fn check_crc(bytes: &[u8], start: usize, end: usize) -> Result<usize, RecordingError> {
    let expected = crc32fast::hash(&bytes[start..end]);
    let found = slice(bytes, end, 4)?;
    if found != expected.to_le_bytes() {
        return Err(RecordingError::Checksum { offset: start });
    }
    Ok(end + 4)
}

fn read_header(bytes: &[u8]) -> Result<(RecordedPad, usize), RecordingError> {
    let head = slice(bytes, 0, HEADER_LEN)?;
    // `slice` gave all HEADER_LEN bytes, which the indices below stay within.
    if head[..8] != MAGIC {
        return Err(RecordingError::NoRecording);
    }
    let version = u16_of(&head[8..]);
    if version != VERSION {
        return Err(RecordingError::Version { found: version });
    }
    let name_len = usize::from(u16_of(&head[16..]));
    let descriptor_len = usize::from(u16_of(&head[18..]));
    let name = slice(bytes, HEADER_LEN, name_len)?;
    let descriptor = slice(bytes, HEADER_LEN + name_len, descriptor_len)?;
    let end = check_crc(bytes, 0, HEADER_LEN + name_len + descriptor_len)?;
    let bus = [Bus::Usb, Bus::Bluetooth, Bus::Other].get(usize::from(head[11])).copied();
    let field = |name, found: u8| RecordingError::Field { name, found: found.into() };
    let pad = RecordedPad {
        id: PadId {
            vendor: u16_of(&head[12..]),
            product: u16_of(&head[14..]),
            bus: bus.ok_or(field("bus", head[11]))?,
        },
        name: String::from_utf8(name.to_vec()).map_err(|_| RecordingError::Name)?,
        descriptor: match head[10] {
            0 => Some(descriptor.to_vec()),
            1 => None,
            other => return Err(field("source", other)),
        },
    };
    Ok((pad, end))
}

type Record = (u64, Kind, std::ops::Range<usize>, usize);

fn read_record(bytes: &[u8], at: usize, hid: bool) -> Result<Record, RecordingError> {
    let (micros, rest) = slice(bytes, at, RECORD_LEN)?.split_at(8);
    let mut time = [0; 8];
    time.copy_from_slice(micros);
    // `slice` gave all RECORD_LEN bytes; four of them are left behind the time.
    let len = usize::from(u16_of(&rest[2..]));
    let body = at + RECORD_LEN..at + RECORD_LEN + len;
    slice(bytes, body.start, len)?;
    let end = check_crc(bytes, at, body.end)?;
    let event = RecordingError::Event { offset: at, kind: rest[0], len };
    let kind = Kind::of(rest[0]).ok_or(event)?;
    let sound = match kind {
        Kind::Report | Kind::Feature => hid && len <= MAX_RECORDED_REPORT,
        // `slice` has found the body inside the file.
        Kind::State => !hid && plain::decode_state(&bytes[body.clone()]).is_some(),
        Kind::Disconnected => len == 0,
        Kind::Calibration => plain::decode_calibration(&bytes[body.clone()]).is_some(),
    };
    if !sound {
        return Err(RecordingError::Event { offset: at, kind: rest[0], len });
    }
    Ok((u64::from_le_bytes(time), kind, body, end))
}
