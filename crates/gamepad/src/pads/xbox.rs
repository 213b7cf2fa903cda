//! Xbox Wireless pads over Bluetooth HID: controls 0x01, guide button 0x02 (old firmware), battery 0x04.
//!
//! Source of the layouts: SDL `src/joystick/hidapi/SDL_hidapi_xboxone.c`
//! (`HIDAPI_DriverXboxOneBluetooth_Handle*`).

use super::bytes::{centred, prefix, press, press_hat, press_pulled_triggers, u16_at};
use crate::{Battery, Button, Buttons, GamepadState, PadInput, Power, ReportError, Update};

/// Firmware of the first Xbox One S: 16 bytes, the guide button in a report of its own.
const OLD_LEN: usize = 16;
const NEW_LEN: usize = 17;

/// Parser of one Xbox Wireless pad.
#[derive(Clone, Debug)]
pub struct XboxWireless {
    has_share: bool,
    guide_apart: bool,
}

impl XboxWireless {
    /// `has_share`: the pad has a share button (Xbox Series).
    #[must_use]
    pub fn new(has_share: bool) -> Self {
        Self { has_share, guide_apart: false }
    }

    /// Reads one report.
    ///
    /// # Errors
    /// [`ReportError`] for short and unknown reports; `input` is unchanged.
    pub fn parse_into(&mut self, report: &[u8], input: &mut PadInput) -> Result<Update, ReportError> {
        match *report.first().ok_or(ReportError::Empty)? {
            0x01 => {
                let common = prefix::<OLD_LEN>(report)?;
                let mut buttons = match prefix::<NEW_LEN>(report) {
                    Ok(report) => self.new_buttons(report),
                    Err(_) => old_buttons(common),
                };
                if self.guide_apart || report.len() < NEW_LEN {
                    buttons.set(Button::Guide, input.raw.buttons.contains(Button::Guide));
                }
                input.raw = controls(common, buttons);
                Ok(Update::Controls)
            }
            0x02 => {
                let report = prefix::<2>(report)?;
                self.guide_apart = true;
                input.raw.buttons.set(Button::Guide, report[1] & 0x01 != 0);
                Ok(Update::Other)
            }
            0x04 => {
                input.battery = Some(battery(prefix::<2>(report)?[1]));
                Ok(Update::Other)
            }
            report_id => Err(ReportError::UnknownReport { report_id }),
        }
    }

    fn new_buttons(&self, report: &[u8; NEW_LEN]) -> Buttons {
        let mut buttons = Buttons::NONE;
        let faces = [
            (0x01, Button::South),
            (0x02, Button::East),
            (0x08, Button::West),
            (0x10, Button::North),
            (0x40, Button::LeftShoulder),
            (0x80, Button::RightShoulder),
        ];
        press(report[14], &faces, &mut buttons);
        let others = [
            (0x04, Button::Select),
            (0x08, Button::Start),
            (0x10, Button::Guide),
            (0x20, Button::LeftStick),
            (0x40, Button::RightStick),
        ];
        press(report[15], &others, &mut buttons);
        let last = if self.has_share { Button::Misc } else { Button::Select };
        press(report[16], &[(0x01, last)], &mut buttons);
        buttons
    }
}

fn old_buttons(report: &[u8; OLD_LEN]) -> Buttons {
    let mut buttons = Buttons::NONE;
    let first = [
        (0x01, Button::South),
        (0x02, Button::East),
        (0x04, Button::West),
        (0x08, Button::North),
        (0x10, Button::LeftShoulder),
        (0x20, Button::RightShoulder),
        (0x40, Button::Select),
        (0x80, Button::Start),
    ];
    press(report[14], &first, &mut buttons);
    press(report[15], &[(0x01, Button::LeftStick), (0x02, Button::RightStick)], &mut buttons);
    buttons
}

/// Sticks of 16 bits with centre 0x8000 and y down, triggers of 10 bits, hat 1 to 8.
fn controls(report: &[u8; OLD_LEN], mut buttons: Buttons) -> GamepadState {
    let axis = |at| centred(u16_at(report, at).into(), 0, 0x8000, 0xffff);
    let pull = |at| f32::from(u16_at(report, at).min(1023)) / 1023.0;
    press_hat(report[13].wrapping_sub(1), &mut buttons);
    let mut state = GamepadState {
        left_stick: [axis(1), 0.0 - axis(3)],
        right_stick: [axis(5), 0.0 - axis(7)],
        left_trigger: pull(9),
        right_trigger: pull(11),
        buttons,
    };
    press_pulled_triggers(&mut state);
    state
}

/// Low two bits: charge in three steps; the next two: 0 means on a cable.
fn battery(flags: u8) -> Battery {
    let percent = match flags & 0x03 {
        0 => 15,
        1 => 55,
        _ => 100,
    };
    let power = if flags & 0x0c == 0 { Power::Charging } else { Power::Discharging };
    Battery { percent: Some(percent), power }
}
