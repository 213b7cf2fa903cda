//! Any manifest around sound tensors: where random bytes in a pack rarely get to, this starts.
#![no_main]

use std::sync::{Arc, LazyLock};

use libfuzzer_sys::fuzz_target;
use policy_core::{CharacterPack, CharacterState, Command, Controller};
use serde_json::Value;

/// The shipped pack: its header as JSON, and the bytes of its tensors.
static SHIPPED: LazyLock<(Value, &[u8])> = LazyLock::new(|| {
    let bytes: &[u8] = include_bytes!("../../assets/humanoid.pack.safetensors");
    let (length, rest) = bytes.split_at(8);
    let length = u64::from_le_bytes(length.try_into().expect("eight bytes")) as usize;
    let header = serde_json::from_slice(&rest[..length]).expect("the shipped pack is sound");
    (header, &rest[length..])
});

fuzz_target!(|manifest: &str| {
    let (header, tensors) = &*SHIPPED;
    let mut header = header.clone();
    header["__metadata__"]["policy_space"] = Value::from(manifest);
    let header = header.to_string();
    let length = (header.len() as u64).to_le_bytes();
    let bytes = [&length[..], header.as_bytes(), tensors].concat();
    let Ok(pack) = CharacterPack::from_bytes(&bytes) else { return };
    let mut controller = Controller::new(Arc::new(pack));
    let targets = controller.tick(&CharacterState::default(), &Command::default(), 1.0 / 30.0);
    assert!(targets.0.iter().all(|target| target.is_finite()));
});
