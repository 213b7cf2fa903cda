//! Xbox Wireless reports made of anything.
#![no_main]

mod hid_checks;

use gamepad::Bus;
use gamepad::pads::{Model, Parser};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    for model in [Model::XboxWireless, Model::XboxSeries] {
        hid_checks::check(&mut Parser::of_model(model, Bus::Bluetooth), bytes);
    }
});
