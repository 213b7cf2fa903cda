//! The bytes of a replay, from a file of anybody: refused, or a replay that is written and played as it was read.
//!
//! The checksum at the end is put right first, or nothing else would ever be read.
#![no_main]

use libfuzzer_sys::fuzz_target;
use replay::{Playback, Replay};

fuzz_target!(|bytes: &[u8]| {
    check(bytes);
    let body = &bytes[..bytes.len().saturating_sub(4)];
    check(&[body, &replay::checksum(body).to_le_bytes()].concat());
});

fn check(bytes: &[u8]) {
    let read = match Replay::from_bytes(bytes) {
        Ok(read) => read,
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    let written = read.to_bytes();
    assert_eq!(Replay::from_bytes(&written).as_ref(), Ok(&read), "what was written can be read");
    if let Ok(link) = read.to_link() {
        assert_eq!(Replay::from_link(&link).as_ref(), Ok(&read), "and as a link");
    }
    let mut playback = Playback::new(&read);
    let mut ticks = 0;
    // An hour of ticks in a few bytes is sound; its first minute is enough here.
    while let Some(pads) = playback.next_pads().filter(|_| ticks < 2000) {
        assert_eq!(pads.len(), usize::from(read.header().players));
        assert!(pads.iter().all(|pad| pad.state().left_stick.iter().all(|v| (-1.0..=1.0).contains(v))));
        let _ = playback.check(0);
        ticks += 1;
    }
    assert!(ticks <= read.ticks());
}
