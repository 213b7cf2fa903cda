//! Any manifest around sound tensors: where random bytes in a pack rarely get to, this starts.
#![no_main]

mod use_pack;

use std::sync::LazyLock;

use libfuzzer_sys::fuzz_target;
use policy_core::CharacterPack;
use serde_json::Value;

/// A sound pack: its header as JSON, and the bytes of its tensors.
static SOUND: LazyLock<(Value, &[u8])> = LazyLock::new(|| {
    let bytes: &[u8] = include_bytes!("../../tests/golden/reference.pack.safetensors");
    let (length, rest) = bytes.split_at(8);
    let length = u64::from_le_bytes(length.try_into().expect("eight bytes")) as usize;
    let header = serde_json::from_slice(&rest[..length]).expect("the pack is sound");
    (header, &rest[length..])
});

fuzz_target!(|manifest: &str| {
    let (header, tensors) = &*SOUND;
    let mut header = header.clone();
    header["__metadata__"]["policy_space"] = Value::from(without_checksum(manifest));
    let header = header.to_string();
    let length = (header.len() as u64).to_le_bytes();
    let bytes = [&length[..], header.as_bytes(), tensors].concat();
    let Ok(pack) = CharacterPack::from_bytes(&bytes) else { return };
    CharacterPack::from_bytes(&pack.to_bytes()).expect("what was written can be read");
    use_pack::steer(pack);
});

/// A checksum would refuse every change before anything else is looked at.
fn without_checksum(manifest: &str) -> String {
    match serde_json::from_str::<Value>(manifest) {
        Ok(Value::Object(mut fields)) => {
            fields.remove("checksum");
            Value::from(fields).to_string()
        }
        _ => manifest.to_owned(),
    }
}
