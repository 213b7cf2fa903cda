//! 8BitDo in its HID modes, byte for byte. Layouts: SDL `SDL_hidapi_8bitdo.c` (`HandleOldStatePacket`,
//! `HandleStatePacket`); places of the face buttons: SDL's game controller database.

mod common;

use common::{each_button, each_hat, near, parser, read, refuse, refuse_cut, unsealed};
use gamepad::pads::Model;
use gamepad::{Battery, Bus, Button, Power, ReportError};

fn rest(len: usize) -> Vec<u8> {
    let mut report = vec![0; len];
    report[..6].copy_from_slice(&[0x04, 0x0f, 127, 127, 127, 127]);
    report
}

const OLD_REST: [u8; 9] = [0, 0, 0x0f, 127, 127, 127, 127, 0, 0];

fn faces(model: Model) -> [Button; 4] {
    match model {
        Model::EightBitDo => [Button::East, Button::South, Button::North, Button::West],
        _ => [Button::South, Button::East, Button::West, Button::North],
    }
}

#[test]
fn every_button() {
    for model in [Model::EightBitDo, Model::EightBitDoUltimate] {
        let [a, b, x, y] = faces(model);
        for (report, first) in [(rest(10), 8), (rest(12), 8), (rest(34), 8), (OLD_REST.to_vec(), 0)] {
            let table = [
                (first, 0x01, a),
                (first, 0x02, b),
                (first, 0x08, x),
                (first, 0x10, y),
                (first, 0x40, Button::LeftShoulder),
                (first, 0x80, Button::RightShoulder),
                (first + 1, 0x01, Button::LeftTrigger),
                (first + 1, 0x02, Button::RightTrigger),
                (first + 1, 0x04, Button::Select),
                (first + 1, 0x08, Button::Start),
                (first + 1, 0x10, Button::Guide),
                (first + 1, 0x20, Button::LeftStick),
                (first + 1, 0x40, Button::RightStick),
            ];
            let mut parser = parser(model, Bus::Usb);
            each_button(&mut parser, &report, unsealed, &table);
            let hat = if report.len() == 9 { 2 } else { 1 };
            each_hat(&mut parser, &report, unsealed, hat, 0, 0xff);
        }
        let mut parser = parser(model, Bus::Usb);
        each_button(&mut parser, &rest(12), unsealed, &[(10, 0x01, Button::Misc), (10, 0x02, Button::Misc)]);
    }
}

#[test]
fn both_ends_of_every_axis() {
    for (report, first) in [(rest(10), 2), (rest(34), 2), (OLD_REST.to_vec(), 3)] {
        for id in [0x01, 0x03, 0x04] {
            let mut parser = parser(Model::EightBitDo, Bus::Usb);
            for (byte, expected) in [(0, -1.0), (127, 0.0), (255, 1.0)] {
                for axis in 0..4 {
                    let mut report = report.clone();
                    if report.len() > 9 {
                        report[0] = id;
                    }
                    report[first + axis] = byte;
                    let raw = read(&mut parser, &report).raw;
                    let sign = if axis % 2 == 1 { -1.0 } else { 1.0 };
                    assert_eq!([raw.left_stick, raw.right_stick].concat()[axis] * sign, expected);
                }
            }
        }
    }
}

#[test]
fn every_trigger_value() {
    let mut parser = parser(Model::EightBitDo, Bus::Usb);
    for value in 0..=255u8 {
        let mut report = rest(34);
        (report[7], report[6]) = (value, 255 - value);
        let raw = read(&mut parser, &report).raw;
        assert_eq!(raw.left_trigger, f32::from(value) / 255.0);
        assert_eq!(raw.right_trigger, f32::from(255 - value) / 255.0);
    }
    let mut old = OLD_REST;
    old[1] = 0x01;
    let raw = read(&mut parser, &old).raw;
    assert_eq!((raw.left_trigger, raw.right_trigger), (1.0, 0.0));
}

#[test]
fn battery_and_motion_of_the_long_report() {
    let mut parser = parser(Model::EightBitDo, Bus::Usb);
    let mut report = rest(34);
    report[14] = 0x80 | 42;
    // Accelerometer z is the pad's y, gyroscope x its -z.
    report[19..21].copy_from_slice(&4096i16.to_le_bytes());
    report[21..23].copy_from_slice(&i16::MAX.to_le_bytes());
    let input = read(&mut parser, &report);
    assert_eq!(input.battery, Some(Battery { percent: Some(42), power: Power::Charging }));
    let motion = input.motion.unwrap();
    near(motion.acceleration[1], 9.80665, 1e-4);
    near(motion.angular_velocity[2], -2000f32.to_radians(), 1e-3);
    report[14] = 100;
    let full = Battery { percent: Some(100), power: Power::Full };
    assert_eq!(read(&mut parser, &report).battery, Some(full));
    assert_eq!(read(&mut parser, &rest(12)).battery, None);
}

#[test]
fn short_and_unknown_reports_are_refused() {
    let mut parser = parser(Model::EightBitDo, Bus::Usb);
    refuse_cut(&mut parser, &rest(10)[..8]);
    assert_eq!(refuse(&mut parser, &[0x09; 34]), ReportError::UnknownReport { report_id: 9 });
}
