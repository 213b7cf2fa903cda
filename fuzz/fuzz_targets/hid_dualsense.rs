//! DualSense reports and calibrations made of anything.
#![no_main]

mod hid_checks;

use gamepad::Bus;
use gamepad::pads::{Model, Parser};
use hid_checks::{check, sealed};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    for bus in [Bus::Usb, Bus::Bluetooth] {
        let mut parser = Parser::of_model(Model::DualSense, bus);
        check(&mut parser, bytes);
        parser.accept_feature(bytes);
        check(&mut parser, bytes);
        if let Some(report) = sealed(bytes) {
            check(&mut parser, &report);
        }
    }
});
