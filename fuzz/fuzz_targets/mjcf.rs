//! A body made of anything: the filter refuses what MuJoCo must not see. What gets through compiles or is refused, and
//! a character of it stands or diverges.
#![no_main]

use libfuzzer_sys::fuzz_target;
use physics_bridge::{Character, Model};
use policy_core::CharacterState;

fuzz_target!(|text: &str| {
    let Ok(model) = Model::from_mjcf(text) else { return };
    let mut character = Character::new(&model);
    let mut state = CharacterState::new(model.skeleton());
    for _ in 0..3 {
        if character.step().is_err() {
            return;
        }
        character.sense_into(&mut state);
        assert!(state.is_finite(), "{state:?}");
    }
});
