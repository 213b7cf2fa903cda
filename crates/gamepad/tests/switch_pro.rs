//! Switch Pro, byte for byte. Layouts: Linux `drivers/hid/hid-nintendo.c` (`joycon_input_report`,
//! `joycon_read_stick_calibration`), SDL `SDL_hidapi_switch.c` (simple report, axes of the sensors).

mod common;

use common::{each_button, each_hat, near, parser, read, refuse, refuse_cut, unsealed};
use gamepad::pads::{Model, Parser};
use gamepad::{Battery, Bus, Button, Buttons, PadInput, Power, ReportError, Update};

/// Two values of 12 bits in three bytes.
fn packed(x: u16, y: u16) -> [u8; 3] {
    [x as u8, (x >> 8) as u8 | (y << 4) as u8, (y >> 4) as u8]
}

fn full() -> (Parser, Vec<u8>) {
    let mut report = vec![0; 64];
    (report[0], report[2]) = (0x30, 0x80);
    report[6..9].copy_from_slice(&packed(2000, 2000));
    report[9..12].copy_from_slice(&packed(2000, 2000));
    (parser(Model::SwitchPro, Bus::Usb), report)
}

fn simple() -> (Parser, Vec<u8>) {
    (parser(Model::SwitchPro, Bus::Bluetooth), vec![0x3f, 0, 0, 8, 0, 0x80, 0, 0x80, 0, 0x80, 0, 0x80])
}

#[test]
fn every_button() {
    let (mut parser, rest) = full();
    let table = [
        (3, 0x01, Button::West),
        (3, 0x02, Button::North),
        (3, 0x04, Button::South),
        (3, 0x08, Button::East),
        (3, 0x40, Button::RightShoulder),
        (3, 0x80, Button::RightTrigger),
        (4, 0x01, Button::Select),
        (4, 0x02, Button::Start),
        (4, 0x04, Button::RightStick),
        (4, 0x08, Button::LeftStick),
        (4, 0x10, Button::Guide),
        (4, 0x20, Button::Misc),
        (5, 0x01, Button::DpadDown),
        (5, 0x02, Button::DpadUp),
        (5, 0x04, Button::DpadRight),
        (5, 0x08, Button::DpadLeft),
        (5, 0x40, Button::LeftShoulder),
        (5, 0x80, Button::LeftTrigger),
    ];
    each_button(&mut parser, &rest, unsealed, &table);
}

#[test]
fn every_button_of_the_simple_report() {
    let (mut parser, rest) = simple();
    let table = [
        (1, 0x01, Button::South),
        (1, 0x02, Button::East),
        (1, 0x04, Button::West),
        (1, 0x08, Button::North),
        (1, 0x10, Button::LeftShoulder),
        (1, 0x20, Button::RightShoulder),
        (1, 0x40, Button::LeftTrigger),
        (1, 0x80, Button::RightTrigger),
        (2, 0x01, Button::Select),
        (2, 0x02, Button::Start),
        (2, 0x04, Button::LeftStick),
        (2, 0x08, Button::RightStick),
        (2, 0x10, Button::Guide),
        (2, 0x20, Button::Misc),
    ];
    each_button(&mut parser, &rest, unsealed, &table);
    each_hat(&mut parser, &rest, unsealed, 3, 0, 0x0f);
    for (value, expected) in [(0, -1.0), (0x8000, 0.0), (0xffff, 1.0_f32)] {
        for axis in 0..4 {
            let mut report = rest.clone();
            report[4 + 2 * axis..][..2].copy_from_slice(&u16::to_le_bytes(value));
            let raw = read(&mut parser, &report).raw;
            let sign = if axis % 2 == 1 { -1.0 } else { 1.0 };
            assert_eq!([raw.left_stick, raw.right_stick].concat()[axis] * sign, expected);
        }
    }
}

#[test]
fn trigger_switches_are_pulls_too() {
    let (mut parser, mut report) = full();
    assert_eq!(read(&mut parser, &report).raw.left_trigger, 0.0);
    (report[3], report[5]) = (0x80, 0x80);
    let raw = read(&mut parser, &report).raw;
    assert_eq!((raw.left_trigger, raw.right_trigger), (1.0, 1.0));
}

#[test]
fn both_ends_of_every_axis_without_calibration() {
    let (mut parser, rest) = full();
    // Without a calibration: 500 to 3500 around 2000, y up.
    for (value, expected) in [(0, -1.0), (500, -1.0), (1250, -0.5), (2000, 0.0), (3500, 1.0), (4095, 1.0)] {
        for axis in 0..4 {
            let mut values = [2000; 4];
            values[axis] = value;
            let mut report = rest.clone();
            report[6..9].copy_from_slice(&packed(values[0], values[1]));
            report[9..12].copy_from_slice(&packed(values[2], values[3]));
            let raw = read(&mut parser, &report).raw;
            assert_eq!([raw.left_stick, raw.right_stick].concat()[axis], expected, "axis {axis}: {value}");
        }
    }
}

/// A reply to a flash read.
fn reply(address: u32, data: &[u8]) -> Vec<u8> {
    let (_, mut report) = full();
    report[0] = 0x21;
    (report[13], report[14], report[19]) = (0x90, 0x10, data.len() as u8);
    report[15..19].copy_from_slice(&address.to_le_bytes());
    report[20..20 + data.len()].copy_from_slice(data);
    report
}

/// Left: above, centre, below. Right: centre, below, above.
const LEFT: [[u16; 2]; 3] = [[1000, 1100], [2100, 2200], [1200, 1300]];
const RIGHT: [[u16; 2]; 3] = [[1900, 1950], [1400, 1450], [1500, 1550]];

fn bytes(pairs: [[u16; 2]; 3]) -> Vec<u8> {
    pairs.iter().flat_map(|[x, y]| packed(*x, *y)).collect()
}

fn sticks(parser: &mut Parser, left: [u16; 2], right: [u16; 2]) -> [[f32; 2]; 2] {
    let (_, mut report) = full();
    report[6..9].copy_from_slice(&packed(left[0], left[1]));
    report[9..12].copy_from_slice(&packed(right[0], right[1]));
    let raw = read(parser, &report).raw;
    [raw.left_stick, raw.right_stick]
}

#[test]
fn the_factorys_stick_calibration_counts() {
    let (mut parser, _) = full();
    let mut input = PadInput::default();
    assert_eq!(parser.parse_into(&reply(0x603d, &bytes(LEFT)), &mut input), Ok(Update::Controls));
    assert_eq!(parser.parse_into(&reply(0x6046, &bytes(RIGHT)), &mut input), Ok(Update::Controls));
    assert_eq!(sticks(&mut parser, [2100, 2200], [1900, 1950]), [[0.0; 2]; 2]);
    assert_eq!(sticks(&mut parser, [3100, 3300], [3400, 3500]), [[1.0; 2]; 2]);
    assert_eq!(sticks(&mut parser, [900, 900], [500, 500]), [[-1.0; 2]; 2]);
    assert_eq!(sticks(&mut parser, [2600, 1550], [1200, 2725]), [[0.5, -0.5], [-0.5, 0.5]]);
}

#[test]
fn the_users_calibration_goes_before_the_factorys() {
    let (mut parser, _) = full();
    let with_magic = |pairs| [vec![0xb2, 0xa1], bytes(pairs)].concat();
    let mut shifted = LEFT;
    shifted[1] = [2300, 2300];
    read(&mut parser, &reply(0x8010, &with_magic(shifted)));
    read(&mut parser, &reply(0x603d, &bytes(LEFT)));
    assert_eq!(sticks(&mut parser, [2300, 2300], [2000, 2000])[0], [0.0; 2]);
    // Without the magic there is none; with zero reaches, or a negative answer, it is not used.
    let (mut parser, _) = full();
    read(&mut parser, &reply(0x8010, &[0xff; 11]));
    read(&mut parser, &reply(0x6046, &[0; 9]));
    let mut refused = reply(0x603d, &bytes(LEFT));
    refused[13] = 0x00;
    read(&mut parser, &refused);
    assert_eq!(sticks(&mut parser, [2000, 2000], [2000, 2000]), [[0.0; 2]; 2]);
}

#[test]
fn motion_is_the_mean_of_three_samples() {
    let (mut parser, mut report) = full();
    for (sample, counts) in [4096i16, 4096, 4096].into_iter().enumerate() {
        // The chip's z is the pad's y; its x the pad's -z.
        report[13 + 12 * sample + 4..][..2].copy_from_slice(&counts.to_le_bytes());
        report[13 + 12 * sample + 6..][..2].copy_from_slice(&(1000 * sample as i16).to_le_bytes());
    }
    let motion = read(&mut parser, &report).motion.unwrap();
    near(motion.acceleration[1], 9.80665, 1e-4);
    near(motion.angular_velocity[2], -(1000.0 / 14.247_f32).to_radians(), 1e-5);
    // The shorter report has none.
    assert_eq!(read(&mut parser, &report[..48]).motion, None);
}

#[test]
fn battery() {
    let (mut parser, mut report) = full();
    let cases = [
        (0x00, Some(5), Power::Discharging),
        (0x20, Some(25), Power::Discharging),
        (0x50, Some(50), Power::Charging),
        (0x60, Some(75), Power::Discharging),
        (0x91, Some(100), Power::Charging),
        (0xa0, None, Power::Unknown),
    ];
    for (status, percent, power) in cases {
        report[2] = status;
        assert_eq!(read(&mut parser, &report).battery, Some(Battery { percent, power }), "{status:#x}");
    }
}

#[test]
fn short_and_unknown_reports_are_refused() {
    let (mut parser, report) = full();
    refuse_cut(&mut parser, &report[..13]);
    refuse_cut(&mut parser, &reply(0x603d, &[])[..13]);
    let (mut parser, report) = simple();
    refuse_cut(&mut parser, &report);
    assert_eq!(refuse(&mut parser, &[0x01; 64]), ReportError::UnknownReport { report_id: 1 });
    let mut input = PadInput::default();
    assert_eq!(parser.parse_into(&[0x81, 0x02], &mut input), Ok(Update::Nothing));
    assert_eq!(input.raw.buttons, Buttons::NONE);
}
