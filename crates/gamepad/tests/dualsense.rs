//! DualSense, byte for byte. Layouts: Linux `drivers/hid/hid-playstation.c` (`dualsense_input_report`,
//! `dualsense_parse_report`), SDL `SDL_hidapi_ps5.c` (simple report).

mod common;

use common::{each_button, each_hat, near, parser, read, refuse, refuse_cut, seal, unsealed};
use gamepad::pads::{Model, Parser};
use gamepad::{Battery, Bus, Button, Power, ReportError};

fn usb() -> (Parser, Vec<u8>) {
    let mut report = vec![0; 64];
    report[..5].copy_from_slice(&[0x01, 128, 128, 128, 128]);
    report[8] = 0x08;
    (report[33], report[37]) = (0x80, 0x80);
    (parser(Model::DualSense, Bus::Usb), report)
}

fn bluetooth() -> (Parser, Vec<u8>) {
    let mut report = vec![0; 78];
    report[..6].copy_from_slice(&[0x31, 0x01, 128, 128, 128, 128]);
    report[9] = 0x08;
    (report[34], report[38]) = (0x80, 0x80);
    seal(&mut report);
    (parser(Model::DualSense, Bus::Bluetooth), report)
}

fn simple() -> (Parser, Vec<u8>) {
    (parser(Model::DualSense, Bus::Bluetooth), vec![0x01, 128, 128, 128, 128, 0x08, 0, 0, 0, 0])
}

/// Each kind of report: where sticks, triggers and buttons start, and what seals it.
fn each_kind(check: impl Fn(Parser, Vec<u8>, [usize; 3], fn(&mut [u8]))) {
    let ((usb, usb_rest), (bt, bt_rest), (simple, simple_rest)) = (usb(), bluetooth(), simple());
    check(usb, usb_rest, [1, 5, 8], unsealed);
    check(bt, bt_rest, [2, 6, 9], seal);
    check(simple, simple_rest, [1, 8, 5], unsealed);
}

#[test]
fn every_button() {
    each_kind(|mut parser, rest, [_, _, at], seal| {
        let table = [
            (at, 0x10, Button::West),
            (at, 0x20, Button::South),
            (at, 0x40, Button::East),
            (at, 0x80, Button::North),
            (at + 1, 0x01, Button::LeftShoulder),
            (at + 1, 0x02, Button::RightShoulder),
            (at + 1, 0x04, Button::LeftTrigger),
            (at + 1, 0x08, Button::RightTrigger),
            (at + 1, 0x10, Button::Select),
            (at + 1, 0x20, Button::Start),
            (at + 1, 0x40, Button::LeftStick),
            (at + 1, 0x80, Button::RightStick),
            (at + 2, 0x01, Button::Guide),
            (at + 2, 0x02, Button::Touchpad),
        ];
        each_button(&mut parser, &rest, seal, &table);
        each_hat(&mut parser, &rest, seal, at, 0, 0x0f);
    });
    for ((mut parser, report), at, seal) in
        [(usb(), 10, unsealed as fn(&mut [u8])), (bluetooth(), 11, seal as fn(&mut [u8]))]
    {
        each_button(&mut parser, &report, seal, &[(at, 0x04, Button::Misc)]);
    }
}

#[test]
fn both_ends_of_every_axis() {
    each_kind(|mut parser, rest, [at, ..], seal| {
        for (byte, expected) in [(0, -1.0), (128, 0.0), (255, 1.0)] {
            for axis in 0..4 {
                let mut report = rest.clone();
                report[at + axis] = byte;
                seal(&mut report);
                let raw = read(&mut parser, &report).raw;
                let found = [raw.left_stick, raw.right_stick].concat();
                let sign = if axis % 2 == 1 { -1.0 } else { 1.0 };
                assert_eq!(found[axis] * sign, expected, "axis {axis}, byte {byte}");
            }
        }
    });
}

#[test]
fn every_trigger_value_also_where_the_simple_report_has_it() {
    each_kind(|mut parser, rest, [_, at, _], seal| {
        for value in 0..=255u8 {
            let mut report = rest.clone();
            (report[at], report[at + 1]) = (value, 255 - value);
            seal(&mut report);
            let raw = read(&mut parser, &report).raw;
            assert_eq!(raw.left_trigger, f32::from(value) / 255.0);
            assert_eq!(raw.right_trigger, f32::from(255 - value) / 255.0);
            assert_eq!((raw.left_stick, raw.buttons.is_empty()), ([0.0; 2], true));
        }
    });
}

#[test]
fn motion_battery_and_touch() {
    let (mut parser, mut report) = bluetooth();
    report[17..19].copy_from_slice(&(-90 * 16i16).to_le_bytes());
    report[25..27].copy_from_slice(&8192i16.to_le_bytes());
    report[54] = 0x17;
    report[34..38].copy_from_slice(&[3, 0x7f, 0x77, 0x43]);
    seal(&mut report);
    let input = read(&mut parser, &report);
    let motion = input.motion.unwrap();
    near(motion.angular_velocity[0], -std::f32::consts::FRAC_PI_2, 1e-5);
    near(motion.acceleration[1], 9.80665, 1e-4);
    assert_eq!(input.battery, Some(Battery { percent: Some(75), power: Power::Charging }));
    let touch = input.touch[0].unwrap();
    // x 0x77f = 1919, y 0x437 = 1079.
    assert_eq!((touch.id, touch.position), (3, [1.0, 0.0]));
    assert_eq!(input.touch[1], None);
}

#[test]
fn every_state_of_the_charger() {
    let (mut parser, mut report) = usb();
    let cases = [
        (0x09, Some(95), Power::Discharging),
        (0x0a, Some(100), Power::Discharging),
        (0x10, Some(5), Power::Charging),
        (0x2a, Some(100), Power::Full),
        (0xa3, None, Power::Unknown),
        (0xf3, None, Power::Unknown),
    ];
    for (status, percent, power) in cases {
        report[53] = status;
        assert_eq!(read(&mut parser, &report).battery, Some(Battery { percent, power }), "{status:#x}");
    }
}

#[test]
fn wrong_checksums_and_lengths_are_refused() {
    let (mut parser, report) = bluetooth();
    for bit in 8..report.len() * 8 {
        let mut broken = report.clone();
        broken[bit / 8] ^= 1 << (bit % 8);
        assert!(matches!(refuse(&mut parser, &broken), ReportError::Checksum { .. }), "bit {bit}");
    }
    refuse_cut(&mut parser, &report);
    let (mut parser, report) = simple();
    refuse_cut(&mut parser, &report);
    let (mut parser, report) = usb();
    refuse_cut(&mut parser, &report);
    assert_eq!(refuse(&mut parser, &[0x02; 64]), ReportError::UnknownReport { report_id: 2 });
}
