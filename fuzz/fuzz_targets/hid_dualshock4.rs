//! DualShock 4 reports and calibrations made of anything.
#![no_main]

mod hid_checks;

use gamepad::Bus;
use gamepad::pads::{Model, Parser};
use hid_checks::{check, sealed};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    for (model, bus) in
        [(Model::DualShock4, Bus::Usb), (Model::DualShock4, Bus::Bluetooth), (Model::DualShock4Receiver, Bus::Usb)]
    {
        let mut parser = Parser::of_model(model, bus);
        check(&mut parser, bytes);
        parser.accept_feature(bytes);
        check(&mut parser, bytes);
        if let Some(report) = sealed(bytes) {
            check(&mut parser, &report);
        }
    }
});
