//! Maps fields of a descriptor to controls of a pad.

use crate::Button;
use crate::descriptor::{Descriptor, Field, Usage};
use crate::pads::PadId;

const DESKTOP: u16 = 0x01;
const SIMULATION: u16 = 0x02;
const BUTTON: u16 = 0x09;
const X: Usage = Usage::new(DESKTOP, 0x30);
const Y: Usage = Usage::new(DESKTOP, 0x31);
const Z: Usage = Usage::new(DESKTOP, 0x32);
const RX: Usage = Usage::new(DESKTOP, 0x33);
const RY: Usage = Usage::new(DESKTOP, 0x34);
const RZ: Usage = Usage::new(DESKTOP, 0x35);
const HAT: Usage = Usage::new(DESKTOP, 0x39);
const ACCELERATOR: Usage = Usage::new(SIMULATION, 0xc4);
const BRAKE: Usage = Usage::new(SIMULATION, 0xc5);

/// Control of a field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Control {
    LeftX,
    LeftY,
    RightX,
    RightY,
    LeftPull,
    RightPull,
    /// Both triggers on one axis: the left one up, the right one down from the middle.
    SharedPull,
    Hat,
    Button(Button),
    /// An array of buttons that starts with this number.
    ButtonArray(u16, ButtonOrder),
    /// Comes before the fields of button arrays.
    ClearButtons,
}

#[derive(Clone, Debug, Default)]
pub(super) struct Mapping {
    pub(super) fields: Vec<(Field, Control)>,
    pub(super) has_pulls: bool,
    pub(super) has_trigger_buttons: bool,
}

/// Meaning of a pad's numbered buttons, which a descriptor does not state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ButtonOrder {
    /// A, B, C, X, Y, Z, shoulders, triggers, select, start, guide, sticks: Android and many Bluetooth pads.
    Linux,
    /// The same with A on the east side, as on Nintendo's pads (8BitDo).
    LinuxNintendo,
    /// West, south, east, north, shoulders, triggers, select, start, sticks, guide: DirectInput pads.
    DirectInput,
    /// A, B, X, Y, shoulders, select, start, sticks, guide: pads that look like an Xbox 360's.
    Xbox,
}

impl ButtonOrder {
    /// The most likely order, from the maker and the number of buttons.
    #[must_use]
    pub fn guess(id: PadId, descriptor: &Descriptor) -> Self {
        const EIGHT_BIT_DO: u16 = 0x2dc8;
        const MICROSOFT: u16 = 0x045e;
        let buttons = || descriptor.fields.iter().filter(|field| is_button(field));
        let highest = buttons().map(|field| field.last_usage.number()).max().unwrap_or(0);
        match (id.vendor, highest) {
            (EIGHT_BIT_DO, _) => Self::LinuxNintendo,
            (_, 15..) => Self::Linux,
            (MICROSOFT, _) | (_, 10 | 11) => Self::Xbox,
            _ => Self::DirectInput,
        }
    }

    /// The button with this number, from 1; `None` past the ones that a pad has.
    #[must_use]
    pub fn button(self, number: u16) -> Option<Button> {
        use Button::*;
        const LINUX: [Option<Button>; 15] = [
            Some(South),
            Some(East),
            None,
            Some(West),
            Some(North),
            None,
            Some(LeftShoulder),
            Some(RightShoulder),
            Some(LeftTrigger),
            Some(RightTrigger),
            Some(Select),
            Some(Start),
            Some(Guide),
            Some(LeftStick),
            Some(RightStick),
        ];
        const DIRECT_INPUT: [Button; 14] = [
            West,
            South,
            East,
            North,
            LeftShoulder,
            RightShoulder,
            LeftTrigger,
            RightTrigger,
            Select,
            Start,
            LeftStick,
            RightStick,
            Guide,
            Touchpad,
        ];
        const XBOX: [Button; 11] = [
            South,
            East,
            West,
            North,
            LeftShoulder,
            RightShoulder,
            Select,
            Start,
            LeftStick,
            RightStick,
            Guide,
        ];
        let index = usize::from(number.checked_sub(1)?);
        match self {
            Self::Linux => LINUX.get(index).copied().flatten(),
            Self::LinuxNintendo => LINUX.get(index).copied().flatten().map(|button| match button {
                South => East,
                East => South,
                West => North,
                North => West,
                other => other,
            }),
            Self::DirectInput => DIRECT_INPUT.get(index).copied(),
            Self::Xbox => XBOX.get(index).copied(),
        }
    }
}

fn is_button(field: &Field) -> bool {
    field.usage.page() == BUTTON && is_pad(field)
}

/// In a collection for a joystick, game pad or multi-axis controller.
fn is_pad(field: &Field) -> bool {
    field.application.page() == DESKTOP && matches!(field.application.number(), 0x04 | 0x05 | 0x08)
}

pub(super) fn map(descriptor: &Descriptor, order: ButtonOrder) -> Mapping {
    let axes = axes(descriptor);
    let mut mapping = Mapping::default();
    let fields = || descriptor.fields.iter().filter(|field| is_pad(field));
    for field in fields().filter(|field| field.is_array && is_button(field)) {
        let cleared = |(known, control): &(Field, Control)| {
            *control == Control::ClearButtons && known.report_id == field.report_id
        };
        if !mapping.fields.iter().any(cleared) {
            mapping.fields.insert(0, (*field, Control::ClearButtons));
        }
        mapping.fields.push((*field, Control::ButtonArray(field.usage.number(), order)));
    }
    for field in fields().filter(|field| !field.is_array) {
        let axis = axes.iter().find(|(usage, _)| *usage == field.usage).map(|found| found.1);
        let control = axis.or_else(|| button_control(field, order));
        // A second field with the same meaning (another hat, a copy in another report) is ignored.
        let known = |control| mapping.fields.iter().any(|(_, other)| *other == control);
        if let Some(control) = control.filter(|&control| !known(control)) {
            mapping.fields.push((*field, control));
        }
    }
    let has = |wanted: &[Control]| mapping.fields.iter().any(|(_, control)| wanted.contains(control));
    mapping.has_pulls = has(&[Control::LeftPull, Control::RightPull, Control::SharedPull]);
    mapping.has_trigger_buttons =
        has(&[Control::Button(Button::LeftTrigger), Control::Button(Button::RightTrigger)])
            || mapping.fields.iter().any(|(_, control)| matches!(control, Control::ButtonArray(..)));
    mapping
}

fn button_control(field: &Field, order: ButtonOrder) -> Option<Control> {
    if is_button(field) {
        return order.button(field.usage.number()).map(Control::Button);
    }
    let button = match (field.usage.page(), field.usage.number()) {
        (DESKTOP, 0x90) => Button::DpadUp,
        (DESKTOP, 0x91) => Button::DpadDown,
        (DESKTOP, 0x92) => Button::DpadRight,
        (DESKTOP, 0x93) => Button::DpadLeft,
        (DESKTOP, 0x3d) => Button::Start,
        (DESKTOP, 0x3e) => Button::Select,
        (DESKTOP, 0x85) => Button::Guide,
        _ => return None,
    };
    Some(Control::Button(button))
}

/// X and Y are the left stick. The right stick is Z and Rz or Rx and Ry, whichever the descriptor names first when
/// it has both; the other pair are the triggers, unless it has accelerator and brake. A lone Z beside Rx and Ry is
/// both triggers.
fn axes(descriptor: &Descriptor) -> Vec<(Usage, Control)> {
    let place = |usage| {
        descriptor.fields.iter().position(|field| field.usage == usage && is_pad(field) && !field.is_array)
    };
    let pair = |first, second| place(first).zip(place(second)).map(|(a, b)| a.min(b));
    let mut axes = vec![(X, Control::LeftX), (Y, Control::LeftY), (HAT, Control::Hat)];
    let pedals = place(ACCELERATOR).is_some() || place(BRAKE).is_some();
    if pedals {
        axes.extend([(BRAKE, Control::LeftPull), (ACCELERATOR, Control::RightPull)]);
    }
    let (z_right, shared) = match (pair(Z, RZ), pair(RX, RY)) {
        (Some(z), Some(r)) => (z < r, false),
        (Some(_), None) => (true, false),
        (None, Some(_)) => (false, place(Z).is_some() && place(RZ).is_none()),
        (None, None) => return axes,
    };
    let (stick, pulls) = if z_right { ([Z, RZ], [RX, RY]) } else { ([RX, RY], [Z, RZ]) };
    axes.extend([(stick[0], Control::RightX), (stick[1], Control::RightY)]);
    if shared && !pedals {
        axes.push((Z, Control::SharedPull));
    } else if !pedals {
        axes.extend([(pulls[0], Control::LeftPull), (pulls[1], Control::RightPull)]);
    }
    axes
}
