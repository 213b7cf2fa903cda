//! What the pads' tests share.
#![allow(dead_code)]

use gamepad::pads::{Model, Parser};
use gamepad::{Bus, Button, Buttons, PadInput, ReportError, Update};

/// CRC32 as the wire has it, bit by bit: not the code under test.
pub fn crc32(seed: u8, bytes: &[u8]) -> u32 {
    let mut crc = !0u32;
    for byte in std::iter::once(seed).chain(bytes.iter().copied()) {
        crc ^= u32::from(byte);
        for _ in 0..8 {
            crc = if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 };
        }
    }
    !crc
}

/// Puts the checksum of an input report into its last four bytes.
pub fn seal(report: &mut [u8]) {
    let at = report.len() - 4;
    let crc = crc32(0xa1, &report[..at]);
    report[at..].copy_from_slice(&crc.to_le_bytes());
}

pub fn parser(model: Model, bus: Bus) -> Parser {
    Parser::of_model(model, bus)
}

/// Parses one report that must be accepted with new controls.
pub fn read(parser: &mut Parser, report: &[u8]) -> PadInput {
    let mut input = PadInput::default();
    assert_eq!(parser.parse_into(report, &mut input), Ok(Update::Controls), "{report:02x?}");
    input
}

/// Parses one report that must be refused and change nothing.
pub fn refuse(parser: &mut Parser, report: &[u8]) -> ReportError {
    let mut input = PadInput::default();
    input.raw.left_trigger = 0.25;
    let before = input;
    let error = parser.parse_into(report, &mut input).expect_err("a refused report");
    assert_eq!(input, before, "a refused report changes nothing");
    error
}

/// Every length shorter than `report` is refused.
pub fn refuse_cut(parser: &mut Parser, report: &[u8]) {
    assert_eq!(refuse(parser, &[]), ReportError::Empty);
    for len in 1..report.len() {
        assert!(matches!(refuse(parser, &report[..len]), ReportError::TooShort { .. }), "{len} bytes");
    }
}

/// One button alone, at each of the given bytes and bits of a report at rest.
pub fn each_button(parser: &mut Parser, rest: &[u8], seal: fn(&mut [u8]), table: &[(usize, u8, Button)]) {
    for &(at, bit, button) in table {
        let mut report = rest.to_vec();
        report[at] |= bit;
        seal(&mut report);
        let held = read(parser, &report).raw.buttons;
        assert_eq!(held, Buttons::NONE.with(button), "byte {at}, bit {bit:#04x}");
    }
}

/// All nine positions of a hat, `first` for up; buttons as bits clockwise from up.
pub fn each_hat(parser: &mut Parser, rest: &[u8], seal: fn(&mut [u8]), at: usize, first: u8, mask: u8) {
    const DIRECTIONS: [(bool, bool, bool, bool); 9] = [
        (true, false, false, false),
        (true, true, false, false),
        (false, true, false, false),
        (false, true, true, false),
        (false, false, true, false),
        (false, false, true, true),
        (false, false, false, true),
        (true, false, false, true),
        (false, false, false, false),
    ];
    for (value, (up, right, down, left)) in (0..).zip(DIRECTIONS) {
        let mut report = rest.to_vec();
        // Past the eighth direction the hat is released; Xbox pads say 0 for that.
        let hat = if value == 8 && first == 1 { 0 } else { value + first };
        report[at] = report[at] & !mask | hat;
        seal(&mut report);
        let held = read(parser, &report).raw.buttons;
        let found = [Button::DpadUp, Button::DpadRight, Button::DpadDown, Button::DpadLeft];
        assert_eq!(found.map(|button| held.contains(button)), [up, right, down, left], "hat {hat}");
    }
}

pub fn unsealed(_: &mut [u8]) {}

pub fn near(found: f32, expected: f32, tolerance: f32) {
    assert!((found - expected).abs() <= tolerance, "expected {expected}, found {found}");
}
