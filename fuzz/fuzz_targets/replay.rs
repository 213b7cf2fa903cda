//! A replay file made of anything: refused, or it gives the same bytes again and a character that steps or diverges.
#![no_main]

use libfuzzer_sys::fuzz_target;
use physics_bridge::ReplayFile;
use policy_core::CharacterState;

fuzz_target!(|bytes: &[u8]| {
    let Ok(file) = ReplayFile::from_bytes(bytes) else { return };
    let written = file.to_bytes();
    let again = ReplayFile::from_bytes(&written).expect("what was written can be read");
    assert_eq!(again.to_bytes(), written, "the same state gives the same bytes");
    let Ok(mut character) = file.to_character() else { return };
    let mut state = CharacterState::new(character.model().skeleton());
    for _ in 0..3 {
        if character.step().is_err() {
            return;
        }
        character.sense_into(&mut state);
        assert!(state.is_finite(), "{state:?}");
    }
});
