//! What a pack costs to load, and a controller's state to save and restore, as data and as bytes.
#![allow(missing_docs, reason = "criterion's macros make a function without any")]

use std::hint::black_box;
use std::sync::Arc;

use criterion::{Criterion, criterion_group, criterion_main};
use policy_core::{CharacterPack, CharacterState, Command, Controller, ControllerState};

const PACK: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/humanoid.pack.safetensors");

fn benches(c: &mut Criterion) {
    let file = std::fs::read(PACK).expect("the pack of the project is there");
    c.bench_function("pack_load", |b| b.iter(|| CharacterPack::from_bytes(black_box(&file)).expect("sound")));

    let pack = Arc::new(CharacterPack::from_bytes(&file).expect("sound"));
    let mut body = CharacterState::new(pack.skeleton());
    body.bodies.iter_mut().for_each(|body| body.position.z = 0.9);
    let mut controller = Controller::new(Arc::clone(&pack));
    for _ in 0..20 {
        controller.tick(&body, &Command::default(), 1.0 / pack.control_hz());
    }
    let mut state = ControllerState::new(&pack);
    c.bench_function("save", |b| b.iter(|| black_box(&controller).save_into(black_box(&mut state))));
    let mut other = Controller::new(Arc::clone(&pack));
    c.bench_function("restore", |b| b.iter(|| other.restore(black_box(&state)).expect("of this pack")));

    let mut bytes = vec![0; state.byte_len()];
    c.bench_function("save_bytes", |b| {
        b.iter(|| {
            controller.save_into(&mut state);
            state.write_bytes(black_box(&mut bytes));
        });
    });
    c.bench_function("restore_bytes", |b| {
        b.iter(|| {
            state.read_bytes(&pack, black_box(&bytes)).expect("written for this pack");
            other.restore(&state).expect("of this pack");
        });
    });
}

criterion_group!(state_benches, benches);
criterion_main!(state_benches);
