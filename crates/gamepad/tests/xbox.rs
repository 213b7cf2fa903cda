//! Xbox Wireless over Bluetooth, byte for byte. Layouts: SDL `SDL_hidapi_xboxone.c`
//! (`HIDAPI_DriverXboxOneBluetooth_HandleButtons16`, `_HandleButtons`, `_HandleStatePacket`, guide, battery).

mod common;

use common::{each_button, each_hat, parser, read, refuse, refuse_cut, unsealed};
use gamepad::pads::Model;
use gamepad::{Battery, Bus, Button, PadInput, Power, ReportError, Update};

fn rest(len: usize) -> Vec<u8> {
    let mut report = vec![0; len];
    report[0] = 0x01;
    for axis in 0..4 {
        report[2 + 2 * axis] = 0x80;
    }
    report
}

#[test]
fn every_button_of_the_old_firmware() {
    let table = [
        (14, 0x01, Button::South),
        (14, 0x02, Button::East),
        (14, 0x04, Button::West),
        (14, 0x08, Button::North),
        (14, 0x10, Button::LeftShoulder),
        (14, 0x20, Button::RightShoulder),
        (14, 0x40, Button::Select),
        (14, 0x80, Button::Start),
        (15, 0x01, Button::LeftStick),
        (15, 0x02, Button::RightStick),
    ];
    let mut parser = parser(Model::XboxWireless, Bus::Bluetooth);
    each_button(&mut parser, &rest(16), unsealed, &table);
    each_hat(&mut parser, &rest(16), unsealed, 13, 1, 0xff);
}

#[test]
fn every_button_of_the_new_firmware() {
    let table = [
        (14, 0x01, Button::South),
        (14, 0x02, Button::East),
        (14, 0x08, Button::West),
        (14, 0x10, Button::North),
        (14, 0x40, Button::LeftShoulder),
        (14, 0x80, Button::RightShoulder),
        (15, 0x04, Button::Select),
        (15, 0x08, Button::Start),
        (15, 0x10, Button::Guide),
        (15, 0x20, Button::LeftStick),
        (15, 0x40, Button::RightStick),
    ];
    for (model, last) in [(Model::XboxWireless, Button::Select), (Model::XboxSeries, Button::Misc)] {
        let mut parser = parser(model, Bus::Bluetooth);
        each_button(&mut parser, &rest(17), unsealed, &table);
        each_button(&mut parser, &rest(17), unsealed, &[(16, 0x01, last)]);
        each_hat(&mut parser, &rest(17), unsealed, 13, 1, 0xff);
    }
}

#[test]
fn the_guide_button_comes_apart() {
    let mut parser = parser(Model::XboxWireless, Bus::Bluetooth);
    let mut input = PadInput::default();
    assert_eq!(parser.parse_into(&[0x02, 0x01], &mut input), Ok(Update::Other));
    assert!(input.raw.buttons.contains(Button::Guide));
    parser.parse_into(&rest(16), &mut input).unwrap();
    assert!(input.raw.buttons.contains(Button::Guide), "held through a report without it");
    parser.parse_into(&[0x02, 0x00], &mut input).unwrap();
    parser.parse_into(&rest(16), &mut input).unwrap();
    assert!(input.raw.buttons.is_empty());
}

#[test]
fn both_ends_of_every_axis() {
    for len in [16, 17] {
        let mut parser = parser(Model::XboxWireless, Bus::Bluetooth);
        for (value, expected) in [(0u16, -1.0), (0x4000, -0.5), (0x8000, 0.0), (0xffff, 1.0)] {
            for axis in 0..4 {
                let mut report = rest(len);
                report[1 + 2 * axis..][..2].copy_from_slice(&value.to_le_bytes());
                let raw = read(&mut parser, &report).raw;
                let sign = if axis % 2 == 1 { -1.0 } else { 1.0 };
                assert_eq!([raw.left_stick, raw.right_stick].concat()[axis] * sign, expected);
            }
        }
    }
}

#[test]
fn every_trigger_value() {
    let mut parser = parser(Model::XboxSeries, Bus::Bluetooth);
    for value in 0..=1023u16 {
        let mut report = rest(17);
        report[9..11].copy_from_slice(&value.to_le_bytes());
        report[11..13].copy_from_slice(&(1023 - value).to_le_bytes());
        let raw = read(&mut parser, &report).raw;
        assert_eq!(raw.left_trigger, f32::from(value) / 1023.0);
        assert_eq!(raw.right_trigger, f32::from(1023 - value) / 1023.0);
        assert_eq!(raw.buttons.contains(Button::LeftTrigger), value > 511);
    }
    let mut report = rest(17);
    report[9..11].copy_from_slice(&[0xff, 0xff]);
    assert_eq!(read(&mut parser, &report).raw.left_trigger, 1.0);
}

#[test]
fn battery_leaves_the_controls_alone() {
    let mut parser = parser(Model::XboxWireless, Bus::Bluetooth);
    let mut input = PadInput::default();
    input.raw.left_trigger = 0.5;
    let cases = [
        (0x04, Some(15), Power::Discharging),
        (0x05, Some(55), Power::Discharging),
        (0x06, Some(100), Power::Discharging),
        (0x03, Some(100), Power::Charging),
    ];
    for (flags, percent, power) in cases {
        assert_eq!(parser.parse_into(&[0x04, flags], &mut input), Ok(Update::Other));
        assert_eq!(input.battery, Some(Battery { percent, power }));
        assert_eq!(input.raw.left_trigger, 0.5);
    }
}

#[test]
fn short_and_unknown_reports_are_refused() {
    let mut parser = parser(Model::XboxWireless, Bus::Bluetooth);
    refuse_cut(&mut parser, &rest(16));
    refuse_cut(&mut parser, &[0x02, 0]);
    refuse_cut(&mut parser, &[0x04, 0]);
    assert_eq!(refuse(&mut parser, &[0x20; 17]), ReportError::UnknownReport { report_id: 0x20 });
}
