//! Any HID pad through its report descriptor.
//!
//! Source of the meanings: *HID Usage Tables*, pages Generic Desktop (0x01), Simulation (0x02), Button (0x09);
//! of the orders of buttons: Linux `drivers/hid/hid-input.c` (`BTN_GAMEPAD` in order), and what DirectInput pads
//! and Xbox pads send.

mod mapping;

pub use mapping::ButtonOrder;
use mapping::{Control, Mapping, map};

use super::PadId;
use super::bytes::{press_hat, press_pulled_triggers};
use crate::descriptor::{Descriptor, DescriptorError, Field};
use crate::{Button, Buttons, GamepadState, PadInput, ReportError, Update};

/// Why a device can't be read as a pad.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NoGamepad {
    /// The descriptor is invalid.
    #[error("report descriptor: {0}")]
    Descriptor(DescriptorError),
    /// The descriptor has no stick and no button in a game pad or joystick collection.
    #[error(
        "report descriptor: expected a game pad or joystick with a stick or buttons, found {fields} other fields"
    )]
    NoControls {
        /// Fields found.
        fields: usize,
    },
}

impl From<DescriptorError> for NoGamepad {
    fn from(error: DescriptorError) -> Self {
        Self::Descriptor(error)
    }
}

/// A pad read through its report descriptor.
#[derive(Clone, Debug)]
pub struct GenericPad {
    has_report_ids: bool,
    report_bits: Vec<(u8, u32)>,
    mapping: Mapping,
}

impl GenericPad {
    /// Reads the descriptor and decides which field is which control.
    ///
    /// # Errors
    /// [`NoGamepad`] when the descriptor is invalid or describes no pad.
    pub fn from_descriptor(id: PadId, bytes: &[u8]) -> Result<Self, NoGamepad> {
        let descriptor = Descriptor::from_bytes(bytes)?;
        Self::new(&descriptor, ButtonOrder::guess(id, &descriptor))
    }

    /// As [`GenericPad::from_descriptor`], with the order of the buttons given.
    ///
    /// # Errors
    /// [`NoGamepad::NoControls`] when the descriptor describes no pad.
    pub fn new(descriptor: &Descriptor, order: ButtonOrder) -> Result<Self, NoGamepad> {
        let mapping = map(descriptor, order);
        if mapping.fields.is_empty() {
            return Err(NoGamepad::NoControls { fields: descriptor.fields.len() });
        }
        Ok(Self {
            has_report_ids: descriptor.has_report_ids,
            report_bits: descriptor.report_bits.clone(),
            mapping,
        })
    }

    /// Reads one report. Controls of other reports keep their values.
    ///
    /// # Errors
    /// [`ReportError`] for reports shorter than the descriptor says and unknown ids; `input` is unchanged.
    pub fn parse_into(&self, report: &[u8], input: &mut PadInput) -> Result<Update, ReportError> {
        let first = *report.first().ok_or(ReportError::Empty)?;
        // There is a first byte, so `1..` is inside.
        let (id, data) = if self.has_report_ids { (first, &report[1..]) } else { (0, report) };
        let Some(&(_, bits)) = self.report_bits.iter().find(|known| known.0 == id) else {
            return Err(ReportError::UnknownReport { report_id: first });
        };
        let expected = bits.div_ceil(8) as usize;
        if data.len() < expected {
            let extra = report.len() - data.len();
            return Err(ReportError::TooShort {
                report_id: first,
                expected: expected + extra,
                found: report.len(),
            });
        }
        let mut update = Update::Nothing;
        let mut hat = None;
        for (field, control) in self.mapping.fields.iter().filter(|(field, _)| field.report_id == id) {
            if let Some(value) = field.value(data) {
                apply(field, *control, value, &mut input.raw, &mut hat);
                update = Update::Controls;
            }
        }
        if let Some(direction) = hat {
            for button in [Button::DpadUp, Button::DpadDown, Button::DpadLeft, Button::DpadRight] {
                input.raw.buttons.set(button, false);
            }
            press_hat(direction, &mut input.raw.buttons);
        }
        self.settle_triggers(&mut input.raw);
        Ok(update)
    }

    /// Derives trigger buttons from analog triggers, and analog triggers from trigger buttons, where one is missing.
    fn settle_triggers(&self, state: &mut GamepadState) {
        match (self.mapping.has_pulls, self.mapping.has_trigger_buttons) {
            (true, false) => press_pulled_triggers(state),
            (false, true) => {
                let pull = |button| if state.buttons.contains(button) { 1.0 } else { 0.0 };
                state.left_trigger = pull(Button::LeftTrigger);
                state.right_trigger = pull(Button::RightTrigger);
            }
            _ => {}
        }
    }
}

fn apply(field: &Field, control: Control, value: i32, state: &mut GamepadState, hat: &mut Option<u8>) {
    let fraction = field.fraction(value);
    let axis = 2.0 * fraction - 1.0;
    match control {
        Control::LeftX => state.left_stick[0] = axis,
        Control::LeftY => state.left_stick[1] = 0.0 - axis,
        Control::RightX => state.right_stick[0] = axis,
        Control::RightY => state.right_stick[1] = 0.0 - axis,
        Control::LeftPull => state.left_trigger = fraction,
        Control::RightPull => state.right_trigger = fraction,
        Control::SharedPull => {
            state.left_trigger = axis.max(0.0);
            state.right_trigger = (-axis).max(0.0);
        }
        Control::Hat => *hat = Some(hat_direction(field, value)),
        Control::Button(button) => state.buttons.set(button, value != 0),
        Control::ButtonArray(first, order) => {
            // An array names the buttons that are held; several fields may share one report.
            if (field.logical_min..=field.logical_max).contains(&value) {
                let number = i64::from(value) - i64::from(field.logical_min) + i64::from(first);
                if let Some(button) = u16::try_from(number).ok().and_then(|number| order.button(number)) {
                    state.buttons.set(button, true);
                }
            }
        }
        Control::ClearButtons => state.buttons = Buttons::NONE,
    }
}

/// Direction clockwise from up in eighths; 8 when released. Hats of four directions have a range of four.
fn hat_direction(field: &Field, value: i32) -> u8 {
    const RELEASED: u8 = 8;
    if !(field.logical_min..=field.logical_max).contains(&value) {
        return RELEASED;
    }
    let step = i64::from(value) - i64::from(field.logical_min);
    // `step` is at least 0 and at most the range, so both casts keep it.
    match i64::from(field.logical_max) - i64::from(field.logical_min) {
        3 => 2 * step as u8,
        7.. if step < 8 => step as u8,
        _ => RELEASED,
    }
}
