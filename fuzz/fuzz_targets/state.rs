//! The bytes of a controller's state, from a save or a network: refused, or a state that the controller can go on from.
#![no_main]

mod use_pack;

use std::sync::{Arc, LazyLock};

use libfuzzer_sys::fuzz_target;
use policy_core::{CharacterPack, CharacterState, Command, Controller, ControllerState, Goal, PathId};

/// A pack, and the bytes of a controller on its way along a path.
static SOUND: LazyLock<(Arc<CharacterPack>, Vec<u8>)> = LazyLock::new(|| {
    let bytes = include_bytes!("../../tests/golden/reference.pack.safetensors");
    let pack = Arc::new(CharacterPack::from_bytes(bytes).expect("the pack is sound"));
    let mut controller = Controller::new(Arc::clone(&pack));
    let goal = Goal::Path { path: PathId::new(0), coordinate: 0.7 };
    for _ in 0..10 {
        controller.tick(&body(&pack), &Command { goal, ..Command::default() }, 1.0 / 30.0);
    }
    let mut state = ControllerState::new(&pack);
    controller.save_into(&mut state);
    let mut bytes = vec![0; state.byte_len()];
    state.write_bytes(&mut bytes);
    (pack, bytes)
});

fuzz_target!(|bytes: &[u8]| {
    check(bytes);
    check(&patched(bytes));
});

fn body(pack: &CharacterPack) -> CharacterState {
    let mut state = CharacterState::new(pack.skeleton());
    state.bodies.iter_mut().for_each(|body| body.position.z = 0.9);
    state
}

/// The sound bytes with changes: each a place (two bytes), a length (one byte) and what to write there.
fn patched(mut patches: &[u8]) -> Vec<u8> {
    let mut bytes = SOUND.1.clone();
    while let Some(([low, high, len], rest)) = patches.split_first_chunk() {
        let (patch, rest) = rest.split_at(rest.len().min(usize::from(len % 9)));
        let at = usize::from(u16::from_le_bytes([*low, *high])) % bytes.len();
        bytes.iter_mut().skip(at).zip(patch).for_each(|(byte, new)| *byte = *new);
        patches = rest;
    }
    bytes
}

fn check(bytes: &[u8]) {
    let pack = &SOUND.0;
    let mut state = ControllerState::new(pack);
    if state.read_bytes(pack, bytes).is_err() {
        assert_eq!(state, ControllerState::new(pack), "a refused state is that of a new controller");
        return;
    }
    let mut controller = Controller::new(Arc::clone(pack));
    controller.restore(&state).expect("a state that was read can be restored");
    let mut saved = ControllerState::new(pack);
    controller.save_into(&mut saved);
    let (mut first, mut second) = (vec![0; state.byte_len()], vec![0; state.byte_len()]);
    state.write_bytes(&mut first);
    saved.write_bytes(&mut second);
    assert_eq!(first, second, "what is restored is what is saved");
    let goal = Goal::Path { path: PathId::new(0), coordinate: 1.5 };
    for _ in 0..4 {
        use_pack::check_tick(&mut controller, &body(pack), &Command { goal, ..Command::default() });
    }
}
