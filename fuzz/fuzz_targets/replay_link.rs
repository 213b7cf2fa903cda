//! The text behind a link, from anybody: refused with a reason, or a replay whose link is the same text.
#![no_main]

use libfuzzer_sys::fuzz_target;
use replay::Replay;

fuzz_target!(|text: &str| {
    match Replay::from_link(text) {
        Ok(read) => {
            let link = read.to_link().expect("it came from a link of that length");
            assert_eq!(Replay::from_link(&link).as_ref(), Ok(&read));
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
