//! What must hold for every report of every pad: refused and nothing changed, or a state that a pad could give.

use gamepad::pads::Parser;
use gamepad::{GamepadState, PadInput};

/// Parses `bytes` as one report, and then as many: each a length byte and that many bytes.
pub fn check(parser: &mut Parser, bytes: &[u8]) {
    let mut input = PadInput::default();
    check_report(parser, bytes, &mut input);
    let mut rest = bytes;
    while let Some((&len, after)) = rest.split_first() {
        let (report, after) = after.split_at(after.len().min(usize::from(len)));
        check_report(parser, report, &mut input);
        rest = after;
    }
}

/// Parses one report.
pub fn check_report(parser: &mut Parser, report: &[u8], input: &mut PadInput) {
    let before = *input;
    match parser.parse_into(report, input) {
        Ok(_) => check_state(&input.raw),
        Err(_) => assert_eq!(before, *input, "a refused report changes nothing"),
    }
    if let Some(motion) = input.motion {
        let values = motion.angular_velocity.into_iter().chain(motion.acceleration);
        assert!(values.into_iter().all(f32::is_finite));
    }
    assert!(input.battery.and_then(|battery| battery.percent).is_none_or(|percent| percent <= 100));
    for touch in input.touch.into_iter().flatten() {
        assert!(touch.position.iter().all(|p| (0.0..=1.0).contains(p)));
    }
}

/// Sticks in [-1, 1], triggers in [0, 1].
pub fn check_state(state: &GamepadState) {
    let sticks = state.left_stick.into_iter().chain(state.right_stick);
    assert!(sticks.into_iter().all(|axis| (-1.0..=1.0).contains(&axis)));
    assert!([state.left_trigger, state.right_trigger].iter().all(|pull| (0.0..=1.0).contains(pull)));
}

/// The first 78 bytes with the checksum that Sony's Bluetooth reports need, so that random bytes get past it.
#[allow(dead_code)]
pub fn sealed(bytes: &[u8]) -> Option<Vec<u8>> {
    let mut report = bytes.get(..74)?.to_vec();
    let mut crc = !0u32;
    for byte in std::iter::once(0xa1).chain(report.iter().copied()) {
        crc ^= u32::from(byte);
        for _ in 0..8 {
            crc = if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 };
        }
    }
    report.extend((!crc).to_le_bytes());
    Some(report)
}
