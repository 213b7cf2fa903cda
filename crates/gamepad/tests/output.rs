//! Rumble and light bar, byte for byte. Layouts: Linux `drivers/hid/hid-playstation.c`
//! (`dualshock4_output_report_*`, `dualsense_output_report_*`), `hid-nintendo.c`; SDL's drivers for the others.

mod common;

use common::crc32;
use gamepad::Bus;
use gamepad::pads::{MAX_OUTPUT_LEN, Model, OutputEncoder, PadOutput, Request};

const OUTPUT: PadOutput = PadOutput { low_rumble: 1.0, high_rumble: 0.2, light: [10, 20, 30] };

fn encoded(encoder: &mut OutputEncoder, output: &PadOutput) -> Vec<u8> {
    let mut out = [0xee; MAX_OUTPUT_LEN];
    let len = encoder.encode_into(output, &mut out);
    out[..len].to_vec()
}

fn first(model: Model, bus: Bus) -> Vec<u8> {
    encoded(&mut OutputEncoder::new(model, bus), &OUTPUT)
}

fn assert_sealed(report: &[u8]) {
    let (bytes, tail) = report.split_last_chunk::<4>().unwrap();
    assert_eq!(crc32(0xa2, bytes).to_le_bytes(), *tail);
}

#[test]
fn dualshock4() {
    let mut expected = vec![0x05, 0x03, 0, 0, 51, 255, 10, 20, 30];
    expected.resize(32, 0);
    assert_eq!(first(Model::DualShock4, Bus::Usb), expected);
    let report = first(Model::DualShock4, Bus::Bluetooth);
    assert_eq!(report.len(), 78);
    assert_eq!(report[..11], [0x11, 0xc4, 0, 0x03, 0, 0, 51, 255, 10, 20, 30]);
    assert!(report[11..74].iter().all(|&byte| byte == 0));
    assert_sealed(&report);
}

#[test]
fn dualsense() {
    let report = first(Model::DualSense, Bus::Usb);
    assert_eq!(report.len(), 63);
    assert_eq!(report[..5], [0x02, 0x03, 0x04, 51, 255]);
    assert_eq!((report[39], report[42]), (0x02, 0x02), "ends the animation of the light bar once");
    assert_eq!(report[45..48], [10, 20, 30]);
    let mut encoder = OutputEncoder::new(Model::DualSense, Bus::Bluetooth);
    for sequence in 0..40u8 {
        let report = encoded(&mut encoder, &OUTPUT);
        assert_eq!(report.len(), 78);
        assert_eq!(report[..7], [0x31, sequence << 4, 0x10, 0x03, 0x04, 51, 255]);
        assert_eq!(report[47..50], [10, 20, 30]);
        assert_eq!(report[41] == 0x02, sequence == 0);
        assert_sealed(&report);
    }
}

#[test]
fn switch_pro() {
    let mut encoder = OutputEncoder::new(Model::SwitchPro, Bus::Bluetooth);
    let quiet = [0x00, 0x01, 0x40, 0x40];
    let off = encoded(&mut encoder, &PadOutput::default());
    assert_eq!(off, [&[0x10, 0][..], &quiet, &quiet].concat());
    // Strongest: amplitude step 100, as in the last line of the kernel's table (0xc8, 0x0072).
    let full = PadOutput { low_rumble: 1.0, high_rumble: 1.0, ..PadOutput::default() };
    let loud = [0x00, 0x01 + 0xc8, 0x40, 0x72];
    assert_eq!(encoded(&mut encoder, &full), [&[0x10, 1][..], &loud, &loud].concat());
    // An odd step sets the top bit of the low band's frequency (0x02, 0x8040 is the first one).
    let least = PadOutput { low_rumble: 0.01, high_rumble: 0.01, ..PadOutput::default() };
    assert_eq!(encoded(&mut encoder, &least)[2..6], [0x00, 0x01 + 0x02, 0xc0, 0x40]);
}

#[test]
fn xbox_and_eightbitdo() {
    assert_eq!(first(Model::XboxSeries, Bus::Bluetooth), [0x03, 0x0f, 0, 0, 100, 20, 0xff, 0, 0xeb]);
    assert_eq!(first(Model::EightBitDo, Bus::Usb), [0x05, 255, 51, 0, 0]);
}

#[test]
fn odd_strengths_are_clamped() {
    let odd = PadOutput { low_rumble: f32::NAN, high_rumble: 9.0, light: [0; 3] };
    let report = encoded(&mut OutputEncoder::new(Model::DualShock4, Bus::Usb), &odd);
    assert_eq!(report[4..6], [255, 0]);
}

#[test]
fn only_sonys_pads_have_a_light() {
    assert!(OutputEncoder::new(Model::DualSense, Bus::Usb).has_light());
    assert!(!OutputEncoder::new(Model::SwitchPro, Bus::Usb).has_light());
}

#[test]
fn start_up() {
    let wireless = Model::DualSense.start_up(Bus::Bluetooth);
    assert_eq!(wireless, [Request::Feature { id: 0x05, len: 41 }]);
    let requests = Model::SwitchPro.start_up(Bus::Usb);
    assert_eq!(requests[0], Request::Output(vec![0x80, 0x02]));
    let quiet = [0x00, 0x01, 0x40, 0x40];
    let read_left = [&[0x01, 0][..], &quiet, &quiet, &[0x10, 0x3d, 0x60, 0, 0, 9]].concat();
    assert_eq!(requests[4], Request::Output(read_left));
    let full_mode = [&[0x01, 6][..], &quiet, &quiet, &[0x03, 0x30]].concat();
    assert_eq!(requests.last(), Some(&Request::Output(full_mode)));
    assert_eq!(Model::SwitchPro.start_up(Bus::Bluetooth).len() + 4, requests.len());
}
