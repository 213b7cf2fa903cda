//! DualShock 4, byte for byte. Layouts: Linux `drivers/hid/hid-playstation.c` (`dualshock4_input_report_usb`,
//! `_bt`, `dualshock4_parse_report`), SDL `SDL_hidapi_ps4.c` (simple report, calibration).

mod common;

use common::{crc32, each_button, each_hat, near, parser, read, refuse, refuse_cut, seal, unsealed};
use gamepad::pads::{Model, Parser};
use gamepad::{Battery, Bus, Button, PadInput, Power, ReportError, Update};

fn usb() -> (Parser, Vec<u8>) {
    let mut report = vec![0; 64];
    report[..7].copy_from_slice(&[0x01, 128, 128, 128, 128, 0x08, 0]);
    report[35..39].copy_from_slice(&[0x80, 0, 0, 0]);
    report[39..43].copy_from_slice(&[0x80, 0, 0, 0]);
    (parser(Model::DualShock4, Bus::Usb), report)
}

fn bluetooth() -> (Parser, Vec<u8>) {
    let mut report = vec![0; 78];
    report[..3].copy_from_slice(&[0x11, 0xc0, 0x00]);
    report[3..8].copy_from_slice(&[128, 128, 128, 128, 0x08]);
    report[37..41].copy_from_slice(&[0x80, 0, 0, 0]);
    report[41..45].copy_from_slice(&[0x80, 0, 0, 0]);
    seal(&mut report);
    (parser(Model::DualShock4, Bus::Bluetooth), report)
}

fn simple() -> (Parser, Vec<u8>) {
    (parser(Model::DualShock4, Bus::Bluetooth), vec![0x01, 128, 128, 128, 128, 0x08, 0, 0, 0, 0])
}

/// Each kind of report, where its controls start, and what seals it.
fn each_kind(check: impl Fn(Parser, Vec<u8>, usize, fn(&mut [u8]))) {
    let ((usb, usb_rest), (bt, bt_rest), (simple, simple_rest)) = (usb(), bluetooth(), simple());
    check(usb, usb_rest, 1, unsealed);
    check(bt, bt_rest, 3, seal);
    check(simple, simple_rest, 1, unsealed);
}

#[test]
fn every_button() {
    each_kind(|mut parser, rest, at, seal| {
        let table = [
            (at + 4, 0x10, Button::West),
            (at + 4, 0x20, Button::South),
            (at + 4, 0x40, Button::East),
            (at + 4, 0x80, Button::North),
            (at + 5, 0x01, Button::LeftShoulder),
            (at + 5, 0x02, Button::RightShoulder),
            (at + 5, 0x04, Button::LeftTrigger),
            (at + 5, 0x08, Button::RightTrigger),
            (at + 5, 0x10, Button::Select),
            (at + 5, 0x20, Button::Start),
            (at + 5, 0x40, Button::LeftStick),
            (at + 5, 0x80, Button::RightStick),
            (at + 6, 0x01, Button::Guide),
            (at + 6, 0x02, Button::Touchpad),
        ];
        each_button(&mut parser, &rest, seal, &table);
        each_hat(&mut parser, &rest, seal, at + 4, 0, 0x0f);
    });
}

#[test]
fn the_counter_beside_the_buttons_is_no_button() {
    let (mut parser, mut report) = usb();
    report[7] = 0xfc;
    assert!(read(&mut parser, &report).raw.buttons.is_empty());
}

#[test]
fn both_ends_of_every_axis() {
    each_kind(|mut parser, rest, at, seal| {
        for (byte, expected) in [(0, -1.0), (1, -1.0), (128, 0.0), (255, 1.0)] {
            for axis in 0..4 {
                let mut report = rest.clone();
                report[at + axis] = byte;
                seal(&mut report);
                let raw = read(&mut parser, &report).raw;
                let found = [raw.left_stick, raw.right_stick].concat();
                let sign = if axis % 2 == 1 { -1.0 } else { 1.0 };
                assert_eq!(found[axis] * sign, expected, "axis {axis}, byte {byte}");
                let others = (0..4).filter(|&other| other != axis).map(|other| found[other]);
                assert!(others.into_iter().all(|value| value == 0.0));
            }
        }
    });
}

#[test]
fn every_trigger_value() {
    each_kind(|mut parser, rest, at, seal| {
        for value in 0..=255u8 {
            let mut report = rest.clone();
            (report[at + 7], report[at + 8]) = (value, 255 - value);
            seal(&mut report);
            let raw = read(&mut parser, &report).raw;
            assert_eq!(raw.left_trigger, f32::from(value) / 255.0);
            assert_eq!(raw.right_trigger, f32::from(255 - value) / 255.0);
        }
    });
}

#[test]
fn motion_in_si_units() {
    let (mut parser, mut report) = usb();
    // 90 degrees/s about y, 1 g along y: 16 counts per degree/s, 8192 per g.
    report[15..17].copy_from_slice(&(90 * 16i16).to_le_bytes());
    report[21..23].copy_from_slice(&8192i16.to_le_bytes());
    report[23..25].copy_from_slice(&(-8192i16).to_le_bytes());
    let motion = read(&mut parser, &report).motion.unwrap();
    near(motion.angular_velocity[1], std::f32::consts::FRAC_PI_2, 1e-5);
    assert_eq!((motion.angular_velocity[0], motion.angular_velocity[2]), (0.0, 0.0));
    near(motion.acceleration[1], 9.80665, 1e-4);
    near(motion.acceleration[2], -9.80665, 1e-4);
}

/// Calibration: three biases, plus and minus of each gyroscope axis, speeds, plus and minus of each accelerometer
/// axis.
fn calibration(id: u8, values: [i16; 17]) -> Vec<u8> {
    let mut report = vec![id];
    report.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    report.resize(41, 0);
    report
}

#[test]
fn the_factorys_calibration_counts() {
    let (mut parser, mut report) = usb();
    report[13..15].copy_from_slice(&(10 + 8000i16).to_le_bytes());
    report[19..21].copy_from_slice(&(100 + 8000i16).to_le_bytes());
    let values =
        [10, 0, 0, 8640, -8640, 8640, -8640, 8640, -8640, 540, 540, 8100, -7900, 8192, -8192, 8192, -8192];
    parser.accept_feature(&calibration(0x02, values));
    let motion = read(&mut parser, &report).motion.unwrap();
    // 1080 degrees/s over 17280 counts, 2 g over 16000 counts around 100.
    near(motion.angular_velocity[0], (8000.0_f32 * 1080.0 / 17280.0).to_radians(), 1e-3);
    near(motion.acceleration[0], 9.80665, 1e-4);
    // Over Bluetooth the plus values come first, and an absurd calibration is not used.
    let (mut wireless, _) = bluetooth();
    let values =
        [0, 0, 0, 8640, 8640, 8640, -8640, -8640, -8640, 540, 540, 8192, -8192, 8192, -8192, 8192, -8192];
    wireless.accept_feature(&calibration(0x05, values));
    wireless.accept_feature(&calibration(0x05, [0; 17]));
    let (_, mut report) = bluetooth();
    report[15..17].copy_from_slice(&1600i16.to_le_bytes());
    seal(&mut report);
    near(read(&mut wireless, &report).motion.unwrap().angular_velocity[0], 100f32.to_radians(), 1e-4);
}

#[test]
fn battery() {
    let cases = [
        (0x00, Some(5), Power::Discharging),
        (0x05, Some(55), Power::Discharging),
        (0x0a, Some(100), Power::Discharging),
        (0x13, Some(35), Power::Charging),
        (0x1a, Some(100), Power::Charging),
        (0x1b, Some(100), Power::Full),
        (0x1e, None, Power::Unknown),
        (0x1f, None, Power::Unknown),
    ];
    for (status, percent, power) in cases {
        let (mut parser, mut report) = usb();
        report[30] = status;
        assert_eq!(read(&mut parser, &report).battery, Some(Battery { percent, power }), "{status:#x}");
    }
}

#[test]
fn touch_of_the_newest_report() {
    let (mut parser, mut report) = usb();
    report[33] = 2;
    // The second touch report: contact 5 at (1919, 0), no second finger.
    report[43..52].copy_from_slice(&[0, 5, 0x7f, 0x07, 0x00, 0x80, 0, 0, 0]);
    let input = read(&mut parser, &report);
    let touch = input.touch[0].unwrap();
    assert_eq!((touch.id, touch.position), (5, [1.0, 1.0]));
    assert_eq!(input.touch[1], None);
}

#[test]
fn a_wrong_checksum_is_refused() {
    let (mut parser, report) = bluetooth();
    for bit in 8..report.len() * 8 {
        let mut broken = report.clone();
        broken[bit / 8] ^= 1 << (bit % 8);
        let error = refuse(&mut parser, &broken);
        assert!(matches!(error, ReportError::Checksum { report_id: 0x11, .. }), "bit {bit}: {error}");
    }
    let found = u32::from_le_bytes(report[74..].try_into().unwrap());
    assert_eq!(found, crc32(0xa1, &report[..74]));
}

#[test]
fn short_and_unknown_reports_are_refused() {
    let (mut parser, report) = usb();
    refuse_cut(&mut parser, &report);
    assert_eq!(refuse(&mut parser, &[0x77; 64]), ReportError::UnknownReport { report_id: 0x77 });
    let (mut parser, report) = bluetooth();
    refuse_cut(&mut parser, &report);
    let (mut parser, report) = simple();
    refuse_cut(&mut parser, &report);
}

#[test]
fn the_receiver_says_when_its_pad_is_off() {
    let mut parser = parser(Model::DualShock4Receiver, Bus::Usb);
    let (_, mut report) = usb();
    assert_eq!(parser.parse_into(&report, &mut PadInput::default()), Ok(Update::Controls));
    report[31] = 0x04;
    assert_eq!(parser.parse_into(&report, &mut PadInput::default()), Ok(Update::Absent));
}
