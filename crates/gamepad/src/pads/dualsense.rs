//! DualSense: USB report 0x01 (64 bytes), Bluetooth 0x01 (simple, triggers elsewhere) and 0x31 (78 bytes, CRC32).
//!
//! Source of the layouts: Linux `drivers/hid/hid-playstation.c` (`dualsense_input_report`,
//! `dualsense_parse_report`), SDL `src/joystick/hidapi/SDL_hidapi_ps5.c` (simple report, calibration).

use super::Bus;
use super::bytes::{prefix, stick_u8, trigger_u8};
use super::sony::{MotionScale, buttons, check_crc, simple_state, touch_point};
use crate::{Battery, Button, GamepadState, PadInput, Power, ReportError, Update};

const TOUCHPAD: [u16; 2] = [1920, 1080];
const SIMPLE_LEN: usize = 10;
const USB_LEN: usize = 64;
const BLUETOOTH_LEN: usize = 78;

/// Parser of one DualSense.
#[derive(Clone, Debug)]
pub struct DualSense {
    bus: Bus,
    motion: MotionScale,
}

impl DualSense {
    /// A pad on `bus`.
    #[must_use]
    pub fn new(bus: Bus) -> Self {
        Self { bus, motion: MotionScale::NOMINAL }
    }

    /// Reads the factory calibration of the motion sensors (feature report 0x05).
    pub fn accept_feature(&mut self, report: &[u8]) {
        if report.first() == Some(&0x05) {
            self.motion = MotionScale::from_feature(report, true).unwrap_or(MotionScale::NOMINAL);
        }
    }

    /// Reads one report.
    ///
    /// # Errors
    /// [`ReportError`] for short, unknown and corrupted reports; `input` is unchanged.
    pub fn parse_into(&self, report: &[u8], input: &mut PadInput) -> Result<Update, ReportError> {
        *input = match (*report.first().ok_or(ReportError::Empty)?, self.bus) {
            (0x01, Bus::Bluetooth) => {
                let [_, simple @ ..] = prefix::<SIMPLE_LEN>(report)?;
                PadInput { raw: simple_state(simple), ..PadInput::default() }
            }
            (0x01, _) => self.full(&prefix::<USB_LEN>(report)?[1..]),
            (0x31, _) => {
                let report = prefix::<BLUETOOTH_LEN>(report)?;
                check_crc(report)?;
                self.full(&report[2..])
            }
            (report_id, _) => return Err(ReportError::UnknownReport { report_id }),
        };
        Ok(Update::Controls)
    }

    /// The 63 bytes that USB and Bluetooth have in common.
    fn full(&self, bytes: &[u8]) -> PadInput {
        let mut held = buttons([bytes[7], bytes[8], bytes[9]]);
        held.set(Button::Misc, bytes[9] & 0x04 != 0);
        PadInput {
            raw: GamepadState {
                left_stick: stick_u8(bytes[0], bytes[1]),
                right_stick: stick_u8(bytes[2], bytes[3]),
                left_trigger: trigger_u8(bytes[4]),
                right_trigger: trigger_u8(bytes[5]),
                buttons: held,
            },
            motion: Some(self.motion.motion(&bytes[15..27])),
            battery: Some(battery(bytes[52])),
            touch: [touch_point(&bytes[32..36], TOUCHPAD), touch_point(&bytes[36..40], TOUCHPAD)],
        }
    }
}

/// Low four bits: tenths of the charge; high four bits: state of the charger.
fn battery(status: u8) -> Battery {
    let percent = Some(((status & 0x0f) * 10 + 5).min(100));
    match status >> 4 {
        0 => Battery { percent, power: Power::Discharging },
        1 => Battery { percent, power: Power::Charging },
        2 => Battery { percent: Some(100), power: Power::Full },
        // 0xa, 0xb: voltage or temperature out of range; 0xf: charger fault.
        _ => Battery { percent: None, power: Power::Unknown },
    }
}
