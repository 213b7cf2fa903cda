//! Switch Pro reports made of anything, replies with stick calibrations among them.
#![no_main]

mod hid_checks;

use gamepad::Bus;
use gamepad::pads::{Model, Parser};
use hid_checks::{check, check_report};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let mut parser = Parser::of_model(Model::SwitchPro, Bus::Usb);
    check(&mut parser, bytes);
    // A reply to a flash read whose address is sound.
    for address in [0x603d_u16, 0x6046, 0x8010, 0x801b] {
        let mut reply = bytes.to_vec();
        reply.resize(reply.len().max(49), 0);
        let [low, high] = address.to_le_bytes();
        reply[0] = 0x21;
        reply[13..19].copy_from_slice(&[0x90, 0x10, low, high, 0, 0]);
        check_report(&mut parser, &reply, &mut gamepad::PadInput::default());
    }
    check(&mut parser, bytes);
});
