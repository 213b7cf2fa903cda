//! Writes a recording, event by event.

use std::io::Write;

use super::{
    HEADER_LEN, Kind, MAGIC, MAX_NAME, MAX_RECORDED_REPORT, MAX_RECORDING_MICROS, PadEvent, RECORD_LEN,
    RecordedPad, RecordingError, VERSION, plain,
};
use crate::descriptor::MAX_DESCRIPTOR_BYTES;
use crate::pads::Bus;

/// Writes one pad's events. Each event is complete once it is written, so a recording may end at any time.
#[derive(Debug)]
pub struct Recorder<W: Write> {
    out: W,
    last_micros: u64,
    /// Reused for every event.
    buffer: Vec<u8>,
}

impl<W: Write> Recorder<W> {
    /// Starts a recording: writes the header. Buffer `out` if it is a file.
    ///
    /// # Errors
    /// [`RecordingError::Io`] when `out` fails.
    pub fn new(mut out: W, pad: &RecordedPad) -> Result<Self, RecordingError> {
        let name = pad.name.as_bytes();
        let name = &name[..pad.name.floor_char_boundary(MAX_NAME)];
        let descriptor = pad.descriptor.as_deref().unwrap_or_default();
        let descriptor = if descriptor.len() > MAX_DESCRIPTOR_BYTES { &[] } else { descriptor };
        let mut buffer = Vec::with_capacity(HEADER_LEN + MAX_RECORDED_REPORT);
        buffer.extend(MAGIC);
        buffer.extend(VERSION.to_le_bytes());
        buffer.push(u8::from(pad.descriptor.is_none()));
        buffer.push(match pad.id.bus {
            Bus::Usb => 0,
            Bus::Bluetooth => 1,
            Bus::Other => 2,
        });
        for number in [pad.id.vendor, pad.id.product, name.len() as u16, descriptor.len() as u16] {
            buffer.extend(number.to_le_bytes());
        }
        buffer.extend(name);
        buffer.extend(descriptor);
        seal(&mut buffer);
        out.write_all(&buffer)?;
        Ok(Self { out, last_micros: 0, buffer })
    }

    /// Writes one event that occurred `time_secs` after the start. An earlier time than the last event's becomes that
    /// time.
    ///
    /// # Errors
    /// [`RecordingError::Io`] when the output fails; [`RecordingError::Event`] for a report that is too long.
    pub fn record(&mut self, time_secs: f64, event: PadEvent<'_>) -> Result<(), RecordingError> {
        let micros = ((time_secs * 1e6).round() as u64).clamp(self.last_micros, MAX_RECORDING_MICROS);
        let (state, calibration);
        let (kind, bytes): (Kind, &[u8]) = match event {
            PadEvent::Report(bytes) => (Kind::Report, bytes),
            PadEvent::Feature(bytes) => (Kind::Feature, bytes),
            PadEvent::State(found) => {
                state = plain::encode_state(&found);
                (Kind::State, &state)
            }
            PadEvent::Disconnected => (Kind::Disconnected, &[]),
            PadEvent::Calibration(found) => {
                calibration = plain::encode_calibration(&found);
                (Kind::Calibration, &calibration)
            }
        };
        if bytes.len() > MAX_RECORDED_REPORT {
            return Err(RecordingError::Event { offset: 0, kind: kind as u8, len: bytes.len() });
        }
        self.buffer.clear();
        self.buffer.reserve(RECORD_LEN + bytes.len() + 4);
        self.buffer.extend(micros.to_le_bytes());
        self.buffer.extend([kind as u8, 0]);
        self.buffer.extend((bytes.len() as u16).to_le_bytes());
        self.buffer.extend(bytes);
        seal(&mut self.buffer);
        self.out.write_all(&self.buffer)?;
        self.last_micros = micros;
        Ok(())
    }

    /// Ends the recording, flushes the output and returns it.
    ///
    /// # Errors
    /// [`RecordingError::Io`] when the output fails.
    pub fn finish(mut self) -> Result<W, RecordingError> {
        self.out.flush()?;
        Ok(self.out)
    }
}

fn seal(buffer: &mut Vec<u8>) {
    let crc = crc32fast::hash(buffer);
    buffer.extend(crc.to_le_bytes());
}
