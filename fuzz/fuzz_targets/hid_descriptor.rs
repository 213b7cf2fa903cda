//! A report descriptor made of anything, and reports of the pad that it describes.
#![no_main]

mod hid_checks;

use gamepad::descriptor::{Descriptor, MAX_FIELDS};
use gamepad::pads::Parser;
use gamepad::{Bus, PadId};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    // Two bytes tell how long the descriptor is; the reports come after it.
    let Some((len, rest)) = bytes.split_first_chunk::<2>() else { return };
    let (descriptor, reports) = rest.split_at(rest.len().min(usize::from(u16::from_le_bytes(*len))));
    if let Ok(found) = Descriptor::from_bytes(descriptor) {
        assert!(found.fields.len() <= MAX_FIELDS);
        for field in &found.fields {
            let fraction = field.value(reports).map_or(0.0, |value| field.fraction(value));
            assert!((0.0..=1.0).contains(&fraction));
        }
    }
    for vendor in [0x045e, 0x2dc8, 0x1234] {
        let id = PadId { vendor, product: 1, bus: Bus::Other };
        if let Ok(mut parser) = Parser::new(id, descriptor) {
            hid_checks::check(&mut parser, reports);
            hid_checks::check(&mut parser, &[0xff; 4096]);
        }
    }
});
