//! Any HID pad through its report descriptor. Source of the items: *Device Class Definition for HID 1.11*, 6.2.2.

mod common;

use common::{near, read, refuse};
use gamepad::descriptor::{Descriptor, DescriptorError, Usage};
use gamepad::pads::{ButtonOrder, GenericPad, Parser};
use gamepad::{Bus, Button, Buttons, NoGamepad, PadId, PadInput, ReportError, Update};
use proptest::prelude::*;

const PAD: PadId = PadId { vendor: 0x1234, product: 0x5678, bus: Bus::Usb };

/// A descriptor as it is written in the specification's examples.
#[derive(Default)]
struct Builder(Vec<u8>);

impl Builder {
    fn item(mut self, kind: u8, value: i32) -> Self {
        let bytes = value.to_le_bytes();
        match value {
            -128..=127 => self.0.extend([kind | 1, bytes[0]]),
            -32768..=32767 => self.0.extend([kind | 2, bytes[0], bytes[1]]),
            _ => self.0.extend([kind | 3, bytes[0], bytes[1], bytes[2], bytes[3]]),
        }
        self
    }
    fn page(self, page: i32) -> Self {
        self.item(0x04, page)
    }
    fn usage(self, usage: i32) -> Self {
        self.item(0x08, usage)
    }
    fn usages(self, first: i32, last: i32) -> Self {
        self.item(0x18, first).item(0x28, last)
    }
    fn application(self, usage: i32) -> Self {
        self.page(1).usage(usage).item(0xa0, 1)
    }
    fn end(mut self) -> Self {
        self.0.push(0xc0);
        self
    }
    fn id(self, id: i32) -> Self {
        self.item(0x84, id)
    }
    fn logical(self, min: i32, max: i32) -> Self {
        self.item(0x14, min).item(0x24, max)
    }
    fn values(self, bits: i32, count: i32, flags: i32) -> Self {
        self.item(0x74, bits).item(0x94, count).item(0x80, flags)
    }
    fn axes(self, usages: &[i32], bits: i32, min: i32, max: i32) -> Self {
        let with_usages = usages.iter().fold(self.page(1), |builder, usage| builder.usage(*usage));
        with_usages.logical(min, max).values(bits, usages.len() as i32, 0x02)
    }
    fn buttons(self, count: i32) -> Self {
        self.page(9).usages(1, count).logical(0, 1).values(1, count, 0x02)
    }
    fn padding(self, bits: i32) -> Self {
        self.values(bits, 1, 0x03)
    }
    fn hat(self) -> Self {
        self.page(1).usage(0x39).logical(0, 7).values(4, 1, 0x42)
    }
    fn pad(&self) -> Parser {
        Parser::new(PAD, &self.0).unwrap()
    }
}

const X: i32 = 0x30;
const Y: i32 = 0x31;
const Z: i32 = 0x32;
const RX: i32 = 0x33;
const RY: i32 = 0x34;
const RZ: i32 = 0x35;

fn direct_input() -> Builder {
    Builder::default().application(5).axes(&[X, Y, Z, RZ], 8, 0, 255).hat().buttons(12).end()
}

#[test]
fn a_direct_input_pad() {
    let mut pad = direct_input().pad();
    let rest = [128, 128, 128, 128, 0x0f, 0x00];
    let raw = read(&mut pad, &rest).raw;
    for value in [raw.left_stick, raw.right_stick].concat() {
        near(value, 0.0, 0.005);
    }
    assert_eq!(raw.buttons, Buttons::NONE);
    let raw = read(&mut pad, &[255, 0, 0, 255, 0x01, 0x00]).raw;
    assert_eq!((raw.left_stick, raw.right_stick), ([1.0, 1.0], [-1.0, -1.0]));
    assert_eq!(raw.buttons, Buttons::NONE.with(Button::DpadUp).with(Button::DpadRight));
    let order = [
        Button::West,
        Button::South,
        Button::East,
        Button::North,
        Button::LeftShoulder,
        Button::RightShoulder,
        Button::LeftTrigger,
        Button::RightTrigger,
        Button::Select,
        Button::Start,
        Button::LeftStick,
        Button::RightStick,
    ];
    for (number, button) in order.into_iter().enumerate() {
        let [low, high] = (0x0f_u16 | 0x10 << number).to_le_bytes();
        let raw = read(&mut pad, &[128, 128, 128, 128, low, high]).raw;
        assert_eq!(raw.buttons, Buttons::NONE.with(button), "button {}", number + 1);
        assert_eq!(raw.left_trigger, if button == Button::LeftTrigger { 1.0 } else { 0.0 });
    }
    assert!(matches!(refuse(&mut pad, &[0; 5]), ReportError::TooShort { expected: 6, found: 5, .. }));
}

#[test]
fn the_right_stick_is_the_pair_named_first() {
    // As on a DualShock 4: the sticks are X, Y, Z, Rz and the triggers Rx, Ry.
    let sony =
        Builder::default().application(5).axes(&[X, Y, Z, RZ], 8, 0, 255).axes(&[RX, RY], 8, 0, 255).end();
    let raw = read(&mut sony.pad(), &[128, 128, 255, 0, 51, 255]).raw;
    assert_eq!(raw.right_stick, [1.0, 1.0]);
    assert_eq!((raw.left_trigger, raw.right_trigger), (0.2, 1.0));
    assert_eq!(raw.buttons, Buttons::NONE.with(Button::RightTrigger));
    // As on most others: the right stick is Rx, Ry and the triggers Z, Rz.
    let xbox = Builder::default()
        .application(5)
        .axes(&[X, Y, RX, RY], 16, -32768, 32767)
        .axes(&[Z, RZ], 8, 0, 255)
        .end();
    let raw = read(&mut xbox.pad(), &[0, 0x80, 0, 0, 0xff, 0x7f, 0, 0x80, 255, 0]).raw;
    assert_eq!((raw.left_stick[0], raw.right_stick), (-1.0, [1.0, 1.0]));
    assert_eq!((raw.left_trigger, raw.right_trigger), (1.0, 0.0));
}

#[test]
fn pedals_are_the_triggers() {
    let pad = Builder::default()
        .application(5)
        .axes(&[X, Y, Z, RZ], 8, 0, 255)
        .page(2)
        .usage(0xc5)
        .usage(0xc4)
        .logical(0, 255)
        .values(8, 2, 2)
        .buttons(15)
        .end();
    let raw = read(&mut pad.pad(), &[128, 128, 128, 128, 255, 51, 0, 0]).raw;
    assert_eq!((raw.left_trigger, raw.right_trigger), (1.0, 0.2));
    let order = ButtonOrder::Linux;
    let raw = read(&mut pad.pad(), &[128, 128, 128, 128, 0, 0, 0x08, 0x40]).raw;
    assert_eq!(order.button(4), Some(Button::West));
    assert_eq!(raw.buttons, Buttons::NONE.with(Button::West).with(Button::RightStick));
}

#[test]
fn one_axis_for_both_triggers() {
    let pad = Builder::default().application(5).axes(&[X, Y, RX, RY, Z], 8, -127, 127).buttons(10).end();
    for (z, left, right) in [(127, 1.0, 0.0), (0, 0.0, 0.0), (-127_i8, 0.0, 1.0)] {
        let raw = read(&mut pad.pad(), &[0, 0, 0, 0, z as u8, 0, 0]).raw;
        assert_eq!((raw.left_trigger, raw.right_trigger), (left, right));
    }
}

#[test]
fn several_reports_and_other_collections() {
    let pad = Builder::default()
        .application(6) // a keyboard
        .id(1)
        .axes(&[X, Y], 8, 0, 255)
        .end()
        .application(4)
        .id(2)
        .axes(&[X, Y], 8, -127, 127)
        .id(3)
        .buttons(8)
        .end();
    let mut parser = pad.pad();
    let mut input = PadInput::default();
    assert_eq!(parser.parse_into(&[1, 255, 255], &mut input), Ok(Update::Nothing));
    assert_eq!(input, PadInput::default());
    assert_eq!(parser.parse_into(&[2, 127, 0x81], &mut input), Ok(Update::Controls));
    assert_eq!(parser.parse_into(&[3, 0x02], &mut input), Ok(Update::Controls));
    assert_eq!((input.raw.left_stick, input.raw.buttons), ([1.0, 1.0], Buttons::NONE.with(Button::South)));
    assert_eq!(refuse(&mut parser, &[9, 0, 0]), ReportError::UnknownReport { report_id: 9 });
}

#[test]
fn hats_of_four_directions_and_dpads_of_buttons() {
    let four = Builder::default().application(5).page(1).usage(0x39).logical(1, 4).values(8, 1, 0x42).end();
    for (value, button) in
        [(1, Button::DpadUp), (2, Button::DpadRight), (3, Button::DpadDown), (4, Button::DpadLeft)]
    {
        assert_eq!(read(&mut four.pad(), &[value]).raw.buttons, Buttons::NONE.with(button));
    }
    assert!(read(&mut four.pad(), &[0]).raw.buttons.is_empty());
    let dpad = Builder::default()
        .application(5)
        .page(1)
        .usages(0x90, 0x93)
        .logical(0, 1)
        .values(1, 4, 2)
        .padding(4)
        .end();
    let all = [Button::DpadUp, Button::DpadDown, Button::DpadRight, Button::DpadLeft];
    for (bit, button) in all.into_iter().enumerate() {
        assert_eq!(read(&mut dpad.pad(), &[1 << bit]).raw.buttons, Buttons::NONE.with(button));
    }
}

#[test]
fn buttons_named_by_an_array() {
    let pad = Builder::default().application(5).page(9).usages(1, 12).logical(1, 12).values(8, 3, 0x00).end();
    let mut parser = pad.pad();
    let mut input = PadInput::default();
    parser.parse_into(&[2, 8, 0], &mut input).unwrap();
    assert_eq!(input.raw.buttons, Buttons::NONE.with(Button::South).with(Button::RightTrigger));
    assert_eq!(input.raw.right_trigger, 1.0);
    parser.parse_into(&[0, 0, 13], &mut input).unwrap();
    assert_eq!((input.raw.buttons, input.raw.right_trigger), (Buttons::NONE, 0.0));
}

#[test]
fn fields_at_odd_bits_with_signs() {
    let bytes =
        Builder::default().application(5).padding(3).axes(&[X, Y], 12, -2048, 2047).padding(5).end().0;
    let descriptor = Descriptor::from_bytes(&bytes).unwrap();
    let [x, y] = [descriptor.fields[0], descriptor.fields[1]];
    assert_eq!((x.usage, x.bit_offset, y.bit_offset), (Usage::new(1, 0x30), 3, 15));
    let packed: u32 = (0x800 << 3) | (0x7ff << 15);
    let report = packed.to_le_bytes();
    assert_eq!((x.value(&report), y.value(&report)), (Some(-2048), Some(2047)));
    assert_eq!((x.fraction(-2048), y.fraction(2047)), (0.0, 1.0));
    assert_eq!(y.value(&report[..3]), None);
    assert_eq!(descriptor.report_bits, [(0, 32)]);
}

#[test]
fn push_pop_long_items_and_unsigned_maxima() {
    let mut bytes = Builder::default().application(5).0;
    bytes.extend([0xfe, 3, 0x55, 1, 2, 3]); // a long item
    bytes.extend([0x15, 0x00, 0x25, 0xff]); // 0 to 255, the maximum in one byte
    bytes.extend([0x75, 8, 0x95, 1, 0xa4]); // push
    bytes.extend([0x15, 0x81, 0x25, 0x7f, 0x09, 0x30, 0x81, 0x02, 0xb4]); // -127 to 127, pop
    bytes.extend([0x09, 0x31, 0x81, 0x02, 0xc0]);
    let fields = Descriptor::from_bytes(&bytes).unwrap().fields;
    assert_eq!((fields[0].logical_min, fields[0].logical_max), (-127, 127));
    assert_eq!((fields[1].logical_min, fields[1].logical_max), (0, 255));
}

#[test]
fn broken_descriptors_are_refused_with_their_place() {
    let refused = |bytes: &[u8]| Descriptor::from_bytes(bytes).expect_err("a broken descriptor");
    assert_eq!(refused(&[0x05, 1, 0x26, 1]), DescriptorError::Truncated { offset: 2, expected: 2, found: 1 });
    assert_eq!(refused(&[0xfe, 9, 0]), DescriptorError::Truncated { offset: 0, expected: 9, found: 0 });
    assert_eq!(refused(&[0xb4]), DescriptorError::Nesting { offset: 0 });
    assert_eq!(refused(&[0xc0]), DescriptorError::Nesting { offset: 0 });
    assert_eq!(refused(&[0xa4; 33]), DescriptorError::Nesting { offset: 32 });
    assert_eq!(refused(&[0x85, 0]), DescriptorError::ReportId { offset: 0, found: 0 });
    assert_eq!(refused(&[0; 4097]), DescriptorError::TooLong { found: 4097 });
    let wide = Builder::default().application(5).usage(X).logical(0, 1).values(33, 1, 2).0;
    assert!(matches!(refused(&wide), DescriptorError::FieldWidth { found: 33, .. }));
    let range = Builder::default().application(5).usage(X).logical(0, -1).item(0x14, 5).values(8, 1, 2).0;
    assert!(Descriptor::from_bytes(&range).is_ok(), "a maximum of 0xff in one byte is 255");
    let range = Builder::default().application(5).usage(X).logical(9, 3).values(8, 1, 2).0;
    assert!(matches!(refused(&range), DescriptorError::Range { min: 9, max: 3, .. }));
    let many = Builder::default().application(5).usage(X).logical(0, 1).values(1, 1025, 2).0;
    assert!(matches!(refused(&many), DescriptorError::TooManyFields { .. }));
    let long = Builder::default().application(5).values(255, i32::MAX, 3).0;
    assert!(matches!(refused(&long), DescriptorError::ReportTooLong { .. }));
}

#[test]
fn a_mouse_is_no_pad() {
    let mouse = Builder::default().application(2).axes(&[X, Y], 8, -127, 127).buttons(3).end();
    assert!(matches!(Parser::new(PAD, &mouse.0), Err(NoGamepad::NoControls { fields: 5 })));
    assert!(matches!(Parser::new(PAD, &[0xc0]), Err(NoGamepad::Descriptor(_))));
}

#[test]
fn the_order_of_the_buttons_is_guessed_and_can_be_given() {
    let order = |count, vendor| {
        let bytes = Builder::default().application(5).buttons(count).end().0;
        ButtonOrder::guess(PadId { vendor, ..PAD }, &Descriptor::from_bytes(&bytes).unwrap())
    };
    assert_eq!(order(10, 0x1234), ButtonOrder::Xbox);
    assert_eq!(order(12, 0x1234), ButtonOrder::DirectInput);
    assert_eq!(order(15, 0x1234), ButtonOrder::Linux);
    assert_eq!(order(15, 0x2dc8), ButtonOrder::LinuxNintendo);
    let descriptor = Descriptor::from_bytes(&direct_input().0).unwrap();
    let pad = GenericPad::new(&descriptor, ButtonOrder::Xbox).unwrap();
    let mut input = PadInput::default();
    pad.parse_into(&[128, 128, 128, 128, 0x1f, 0], &mut input).unwrap();
    assert_eq!(input.raw.buttons, Buttons::NONE.with(Button::South));
}

proptest! {
    #[test]
    fn any_descriptor_and_report_gives_a_state_a_pad_could_have(
        bytes in proptest::collection::vec(any::<u8>(), 0..600),
        report in proptest::collection::vec(any::<u8>(), 0..80),
    ) {
        let known = direct_input().0;
        for descriptor in [bytes.clone(), [known, bytes].concat()] {
            if let Ok(mut parser) = Parser::new(PAD, &descriptor) {
                let mut input = PadInput::default();
                let _ = parser.parse_into(&report, &mut input);
                let axes = [input.raw.left_stick, input.raw.right_stick].concat();
                prop_assert!(axes.iter().all(|axis| (-1.0..=1.0).contains(axis)));
            }
        }
    }
}
