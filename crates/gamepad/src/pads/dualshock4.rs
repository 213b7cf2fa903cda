//! DualShock 4: USB report 0x01 (64 bytes), Bluetooth 0x01 (simple) and 0x11 (78 bytes, CRC32), USB receiver.
//!
//! Source of the layouts: Linux `drivers/hid/hid-playstation.c` (`dualshock4_input_report_*`,
//! `dualshock4_parse_report`), SDL `src/joystick/hidapi/SDL_hidapi_ps4.c`.

use super::Bus;
use super::bytes::prefix;
use super::sony::{MotionScale, check_crc, simple_state, touch_point};
use crate::{Battery, PadInput, Power, ReportError, Update};

const TOUCHPAD: [u16; 2] = [1920, 942];
const SIMPLE_LEN: usize = 10;
const USB_LEN: usize = 64;
const BLUETOOTH_LEN: usize = 78;
/// Length of the part that USB and Bluetooth have in common: controls, motion, status.
const COMMON_LEN: usize = 32;

/// Parser of one DualShock 4.
#[derive(Clone, Debug)]
pub struct DualShock4 {
    bus: Bus,
    receiver: bool,
    motion: MotionScale,
}

impl DualShock4 {
    /// A pad on `bus`; `receiver` for Sony's USB wireless adaptor, which reports even without a pad.
    #[must_use]
    pub fn new(bus: Bus, receiver: bool) -> Self {
        Self { bus, receiver, motion: MotionScale::NOMINAL }
    }

    /// Reads the factory calibration of the motion sensors (feature report 0x02, over Bluetooth 0x05).
    pub fn accept_feature(&mut self, report: &[u8]) {
        let pairs = match report.first() {
            Some(0x02) => !self.receiver,
            Some(0x05) => false,
            _ => return,
        };
        self.motion = MotionScale::from_feature(report, pairs).unwrap_or(MotionScale::NOMINAL);
    }

    /// Reads one report.
    ///
    /// # Errors
    /// [`ReportError`] for short, unknown and corrupted reports; `input` is unchanged.
    pub fn parse_into(&self, report: &[u8], input: &mut PadInput) -> Result<Update, ReportError> {
        match (*report.first().ok_or(ReportError::Empty)?, self.bus) {
            (0x01, Bus::Bluetooth) => {
                let [_, simple @ ..] = prefix::<SIMPLE_LEN>(report)?;
                *input = PadInput { raw: simple_state(simple), ..PadInput::default() };
            }
            (0x01, _) => {
                let report = prefix::<USB_LEN>(report)?;
                if self.receiver && report[1 + 30] & 0x04 != 0 {
                    return Ok(Update::Absent);
                }
                *input = self.full(&report[1..], 3);
            }
            (0x11, _) => {
                let report = prefix::<BLUETOOTH_LEN>(report)?;
                check_crc(report)?;
                *input = self.full(&report[3..], 4);
            }
            // Audio reports over Bluetooth; their controls are not needed, since 0x11 is sent as well.
            (0x12..=0x19, Bus::Bluetooth) => return Ok(Update::Nothing),
            (report_id, _) => return Err(ReportError::UnknownReport { report_id }),
        }
        Ok(Update::Controls)
    }

    /// The common part and up to `most_touches` touch reports of nine bytes after it.
    fn full(&self, bytes: &[u8], most_touches: u8) -> PadInput {
        let mut simple = [0; 9];
        simple.copy_from_slice(&bytes[..9]);
        let mut input = PadInput {
            raw: simple_state(&simple),
            motion: Some(self.motion.motion(&bytes[12..24])),
            battery: Some(battery(bytes[29])),
            touch: [None; 2],
        };
        let touches = usize::from(bytes[COMMON_LEN].min(most_touches));
        if let Some(newest) = touches.checked_sub(1) {
            let points = &bytes[COMMON_LEN + 1 + 9 * newest + 1..];
            input.touch = [touch_point(points, TOUCHPAD), touch_point(&points[4..], TOUCHPAD)];
        }
        input
    }
}

/// Low four bits: tenths of the charge, 11 full; bit 4: a cable is plugged in.
fn battery(status: u8) -> Battery {
    let level = status & 0x0f;
    let percent = if level < 10 { level * 10 + 5 } else { 100 };
    match (status & 0x10 != 0, level) {
        (false, _) => Battery { percent: Some(percent), power: Power::Discharging },
        (true, 0..=10) => Battery { percent: Some(percent), power: Power::Charging },
        (true, 11) => Battery { percent: Some(100), power: Power::Full },
        (true, _) => Battery { percent: None, power: Power::Unknown },
    }
}
