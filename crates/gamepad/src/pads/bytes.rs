//! Reads numbers, hats and sticks from report bytes.

use crate::{Button, Buttons, GamepadState, ReportError};

pub(crate) const GRAVITY: f32 = 9.806_65;

/// The first `N` bytes, or an error.
pub(crate) fn prefix<const N: usize>(report: &[u8]) -> Result<&[u8; N], ReportError> {
    let report_id = *report.first().ok_or(ReportError::Empty)?;
    report.first_chunk().ok_or(ReportError::TooShort { report_id, expected: N, found: report.len() })
}

pub(crate) fn u16_at(bytes: &[u8], at: usize) -> u16 {
    u16::from_le_bytes([bytes[at], bytes[at + 1]])
}

pub(crate) fn i16_at(bytes: &[u8], at: usize) -> i16 {
    i16::from_le_bytes([bytes[at], bytes[at + 1]])
}

pub(crate) fn i16x3_at(bytes: &[u8], at: usize) -> [i16; 3] {
    [i16_at(bytes, at), i16_at(bytes, at + 2), i16_at(bytes, at + 4)]
}

/// Maps `low..centre..high` to [-1, 0, 1], each half linearly; clamps. `low < centre < high`.
pub(crate) fn centred(value: i32, low: i32, centre: i32, high: i32) -> f32 {
    let reach = if value < centre { centre - low } else { high - centre };
    ((value - centre) as f32 / reach as f32).clamp(-1.0, 1.0)
}

/// A stick of two bytes, centre 128, y down, as Sony's pads report it.
pub(crate) fn stick_u8(x: u8, y: u8) -> [f32; 2] {
    [centred(x.into(), 1, 128, 255), 0.0 - centred(y.into(), 1, 128, 255)]
}

pub(crate) fn trigger_u8(value: u8) -> f32 {
    f32::from(value) / 255.0
}

/// Presses the buttons whose bit is set in `byte`.
pub(crate) fn press(byte: u8, bits: &[(u8, Button)], buttons: &mut Buttons) {
    for &(bit, button) in bits {
        if byte & bit != 0 {
            buttons.set(button, true);
        }
    }
}

/// A hat of eight directions clockwise from up; anything else is released.
pub(crate) fn press_hat(direction: u8, buttons: &mut Buttons) {
    if direction < 8 {
        buttons.set(Button::DpadUp, matches!(direction, 7 | 0 | 1));
        buttons.set(Button::DpadRight, matches!(direction, 1..=3));
        buttons.set(Button::DpadDown, matches!(direction, 3..=5));
        buttons.set(Button::DpadLeft, matches!(direction, 5..=7));
    }
}

/// Presses the trigger buttons from the pull, for pads that have no switch there.
pub(crate) fn press_pulled_triggers(state: &mut GamepadState) {
    const PRESSED: f32 = 0.5;
    state.buttons.set(Button::LeftTrigger, state.left_trigger > PRESSED);
    state.buttons.set(Button::RightTrigger, state.right_trigger > PRESSED);
}
