//! Sound files for every reader: those that the project ships, those in `tests/hostile/seeds`, and made ones.

use std::fs;
use std::path::{Path, PathBuf};

use gamepad::recording::{PadEvent, RecordedPad, Recorder};
use gamepad::{Bus, PadId};
use integration_tests::{DT_SECS, HUMANOID_MJCF, QUADRUPED_MJCF, made_up, reference_pack};
use physics_bridge::{Character, Model};
use policy_core::{CharacterState, Command, Controller, ControllerState, PolicyId};
use viewer::app::PanelLayout;

/// Report descriptor of a pad with four axes and twelve buttons.
const DESCRIPTOR: &[u8] = &[
    0x05, 0x01, 0x09, 0x05, 0xa1, 0x01, 0x15, 0x00, 0x26, 0xff, 0x00, 0x75, 0x08, 0x95, 0x04, 0x09, 0x30,
    0x09, 0x31, 0x09, 0x32, 0x09, 0x35, 0x81, 0x02, 0x25, 0x07, 0x75, 0x04, 0x95, 0x01, 0x09, 0x39, 0x81,
    0x42, 0x25, 0x01, 0x75, 0x01, 0x95, 0x0c, 0x05, 0x09, 0x19, 0x01, 0x29, 0x0c, 0x81, 0x02, 0xc0,
];

/// Writes the sound files below `folder`.
///
/// # Panics
/// When that fails: there is nothing to test then.
pub fn write(folder: &Path) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let assets = root.join("assets");
    let copy = |reader: &str, path: PathBuf| {
        let to = folder.join(reader);
        fs::create_dir_all(&to).expect("the folder of a reader can be made");
        let name = path.file_name().expect("every sound file has a name");
        fs::copy(&path, to.join(name)).unwrap_or_else(|error| panic!("copy {}: {error}", path.display()));
    };
    copy("pack", root.join("tests/golden/reference.pack.safetensors"));
    copy("dropped", assets.join("humanoid.glb"));
    copy("dropped", root.join("tests/golden/reference.pack.safetensors"));
    copy("mjcf", root.join("tests/assets/quadruped.xml"));
    copy("character", assets.join("recipes/characters/humanoid.toml"));
    copy("lineage", assets.join("recipes/lineage/humanoid.toml"));
    copy("mjcf", assets.join("humanoid.xml"));
    copy("plan", assets.join("recipes/pack/humanoid.toml"));
    for (reader, ending, from) in [
        ("recipe", "toml", "recipes"),
        ("script", "ron", "scripts"),
        ("checkpoint", "safetensors", "checkpoints"),
    ] {
        for path in files(&assets.join(from), ending) {
            // A small file is quicker to break, and its header is a larger part of it.
            if fs::metadata(&path).is_ok_and(|meta| meta.len() < 3 << 20) {
                copy(reader, path);
            }
        }
    }
    copy("normalisers", assets.join("checkpoints/normaliser.safetensors"));
    for ending in ["json", "npy", "txt"] {
        files(&root.join("tests/hostile/seeds/clip"), ending).into_iter().for_each(|path| copy("clip", path));
    }
    write_made(folder);
}

/// Sound files that only the libraries can write.
fn write_made(folder: &Path) {
    let make = |reader: &str, name: &str, bytes: &[u8]| {
        fs::create_dir_all(folder.join(reader)).expect("the folder of a reader can be made");
        fs::write(folder.join(reader).join(name), bytes).expect("a sound file can be written");
    };
    make("descriptor", "pad.bin", DESCRIPTOR);
    make("recording", "dualsense.pad", &recording(0x054c, 0x0ce6, Vec::new()));
    make("recording", "generic.pad", &recording(0x1234, 0x5678, DESCRIPTOR.to_vec()));
    // Version 2 without its checksum, which would hide everything behind it.
    let quadruped = Model::from_mjcf(QUADRUPED_MJCF).expect("the quadruped compiles");
    make(
        "pack",
        "quadruped.pack.safetensors",
        &without_checksum(&made_up::pack(&quadruped, QUADRUPED_MJCF).to_bytes()),
    );
    make("state", "walking.state", &state());
    let pack = reference_pack();
    make("onnx", "policy.onnx", &trainer::onnx::policy_model(&pack, PolicyId::new(1)));
    make("deployment", "deployment.json", trainer::onnx::Deployment::of(&pack).to_json().as_bytes());
    let character = Character::new(&Model::from_mjcf(HUMANOID_MJCF).expect("the humanoid compiles"));
    make("replay_file", "standing.json", &character.replay_file().to_bytes());
    let qpos = character.pose().qpos;
    let qpos = serde_json::to_string(&[&qpos, &qpos, &qpos]).expect("numbers are JSON");
    let poses = format!("{{\"format\":\"policy-space poses\",\"clip\":\"still\",\"hz\":30,\"qpos\":{qpos}}}");
    make("pose_clip", "still.json", poses.as_bytes());
    let layout = folder.join("layout/layout.ron");
    PanelLayout::default().save(&layout).expect("a layout can be written");
}

/// A pack whose manifest has no checksum. The header keeps its length, so that the tensors keep their places.
fn without_checksum(pack: &[u8]) -> Vec<u8> {
    let mark = br#"\"checksum\":\""#;
    let at = pack
        .windows(mark.len())
        .position(|bytes| bytes == mark)
        .expect("a pack that is written has a checksum");
    // The field, its eight digits, the closing quote and the comma make way for spaces.
    let mut out = pack.to_vec();
    out[at..at + mark.len() + 8 + 3].fill(b' ');
    out
}

/// A controller's state after some ticks.
fn state() -> Vec<u8> {
    let pack = reference_pack();
    let mut body = CharacterState::new(pack.skeleton());
    body.bodies.iter_mut().for_each(|body| body.position.z = 0.9);
    let mut controller = Controller::new(pack.clone());
    (0..20).for_each(|_| drop(controller.tick(&body, &Command::default(), DT_SECS).to_vec()));
    let mut state = ControllerState::new(&pack);
    controller.save_into(&mut state);
    let mut bytes = vec![0; state.byte_len()];
    state.write_bytes(&mut bytes);
    bytes
}

fn recording(vendor: u16, product: u16, descriptor: Vec<u8>) -> Vec<u8> {
    let pad = RecordedPad {
        id: PadId { vendor, product, bus: Bus::Usb },
        name: "a pad".into(),
        descriptor: Some(descriptor),
    };
    let mut recorder = Recorder::new(Vec::new(), &pad).expect("memory takes everything");
    for step in 0..20u8 {
        let report = [1, step, 128, 128, 128, 0, 0, 8, 0, 0];
        let event = if step == 10 { PadEvent::Disconnected } else { PadEvent::Report(&report) };
        recorder.record(f64::from(step) * 0.01, event).expect("memory takes everything");
    }
    recorder.finish().expect("memory takes everything")
}

fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap_or_else(|error| panic!("list {}: {error}", folder.display()));
    let paths = entries.map(|entry| entry.expect("an entry can be read").path());
    paths.filter(|path| path.extension().is_some_and(|found| found == ending)).collect()
}
