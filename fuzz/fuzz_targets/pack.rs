//! A character pack made of anything: it is refused, or it survives a round trip and can be steered by.
#![no_main]

use std::sync::Arc;

use libfuzzer_sys::fuzz_target;
use policy_core::{CharacterPack, CharacterState, Command, Controller};

fuzz_target!(|bytes: &[u8]| {
    let Ok(pack) = CharacterPack::from_bytes(bytes) else { return };
    let written = pack.to_bytes();
    let again = CharacterPack::from_bytes(&written).expect("what was written can be read");
    assert_eq!(again.to_bytes(), written, "the same pack gives the same bytes");
    let mut controller = Controller::new(Arc::new(pack));
    let targets = controller.tick(&CharacterState::default(), &Command::default(), 1.0 / 30.0);
    assert!(targets.0.iter().all(|target| target.is_finite()));
});
