//! A character pack made of anything: it is refused, or it survives a round trip and can be steered by.
#![no_main]

mod use_pack;

use libfuzzer_sys::fuzz_target;
use policy_core::CharacterPack;

fuzz_target!(|bytes: &[u8]| {
    let Ok(pack) = CharacterPack::from_bytes(bytes) else { return };
    let written = pack.to_bytes();
    let again = CharacterPack::from_bytes(&written).expect("what was written can be read");
    assert_eq!(again.to_bytes(), written, "the same pack gives the same bytes");
    use_pack::steer(pack);
});
