//! A checkpoint made of anything: refused, or one that gives the same networks when it is written and read again.
//! Metadata that is any text around sound tensors is tried too.
#![no_main]

use std::path::Path;
use std::sync::LazyLock;

use libfuzzer_sys::fuzz_target;
use serde_json::Value;
use trainer::checkpoint::Checkpoint;

/// The header of a small checkpoint as JSON, and the bytes of its tensors.
static SOUND: LazyLock<(Value, &[u8])> = LazyLock::new(|| {
    let bytes: &[u8] = include_bytes!("../seeds/checkpoint/small.safetensors");
    let (length, rest) = bytes.split_at(8);
    let length = u64::from_le_bytes(length.try_into().expect("eight bytes")) as usize;
    (serde_json::from_slice(&rest[..length]).expect("the checkpoint is sound"), &rest[length..])
});

fuzz_target!(|bytes: &[u8]| {
    read(bytes);
    if let Ok(progress) = std::str::from_utf8(bytes) {
        let (header, tensors) = &*SOUND;
        let mut header = header.clone();
        header["__metadata__"]["progress"] = Value::from(progress);
        let header = header.to_string();
        let length = (header.len() as u64).to_le_bytes();
        read(&[&length[..], header.as_bytes(), tensors].concat());
    }
});

fn read(bytes: &[u8]) {
    let path = Path::new("checkpoint.safetensors");
    let Ok(checkpoint) = Checkpoint::from_bytes(path, bytes) else { return };
    for trained in checkpoint.networks.values() {
        assert!(trained.network.parameters.iter().all(|number| number.is_finite()));
    }
    let written = checkpoint.to_bytes().expect("a checkpoint can be written");
    let again = Checkpoint::from_bytes(path, &written).expect("what was written can be read");
    assert_eq!(again, checkpoint);
    let _ = again.slim();
}
