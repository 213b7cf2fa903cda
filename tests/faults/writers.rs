//! What writes files that must not be lost: each with a way to write a version and to tell which one is there.

use std::cell::RefCell;
use std::collections::HashMap;
use std::path::Path;

use glam::Vec3;
use integration_tests::HUMANOID_MJCF;
use physics_bridge::{Character, Model, ReplayFile};
use policy_core::Skeleton;
use policy_core::training::Normaliser;
use trainer::Rng;
use trainer::checkpoint::{ACTOR, Checkpoint, Trained};
use trainer::env::Normalisers;
use trainer::nn::{Adam, Network};
use trainer::normaliser_file;
use trainer::run::{Existing, RunFolder, newest_checkpoint};
use viewer::app::{PanelLayout, Preset};

/// One kind of file.
pub struct Writer {
    pub name: &'static str,
    /// Writes a version into a folder.
    pub write: fn(&Path, u64) -> Result<(), String>,
    /// The version that is there; an error when it is not whole.
    pub read: fn(&Path) -> Result<Option<u64>, String>,
}

pub const ALL: &[Writer] = &[
    Writer { name: "checkpoint", write: write_checkpoint, read: read_checkpoint },
    Writer { name: "normalisers", write: write_normalisers, read: read_normalisers },
    Writer { name: "layout", write: write_layout, read: read_layout },
    Writer { name: "replay", write: write_replay, read: read_replay },
    Writer { name: "report", write: write_report, read: read_report },
];

thread_local! {
    /// The folder of the run that this process has locked.
    static RUN: RefCell<Option<RunFolder>> = const { RefCell::new(None) };
    /// A character to write replay files of.
    static CHARACTER: RefCell<Option<Character>> = const { RefCell::new(None) };
}

/// Lets go of the lock that writing a checkpoint took.
pub fn let_go() {
    RUN.take();
}

/// The message of an error and of its sources.
fn told(error: &dyn std::error::Error) -> String {
    error.source().map_or_else(|| error.to_string(), |source| format!("{error}: {}", told(source)))
}

fn write_checkpoint(folder: &Path, version: u64) -> Result<(), String> {
    RUN.with_borrow_mut(|run| {
        let run = match run {
            Some(run) => run,
            none => none
                .insert(RunFolder::open(folder.join("run"), Existing::Resume).map_err(|error| told(&error))?),
        };
        let mut rng = Rng::new(version, 1);
        let network = Network::new(&[60, 128, 28], 1.0, &mut rng);
        let adam = Adam { steps: 7, ..Adam::new(network.parameters.len()) };
        let networks = HashMap::from([(ACTOR.to_owned(), Trained { network, adam })]);
        let checkpoint = Checkpoint::new(networks, (1, version, 3.0), 1e-4, rng);
        run.save(&checkpoint).map_err(|error| told(&error))
    })
}

fn read_checkpoint(folder: &Path) -> Result<Option<u64>, String> {
    let loaded = newest_checkpoint(&folder.join("run")).map_err(|error| told(&error))?;
    Ok(loaded.map(|loaded| loaded.checkpoint.progress.samples))
}

/// The version that a file holds; `None` when there is none.
fn of_file<T>(path: &Path, load: impl FnOnce(&Path) -> Result<T, String>) -> Result<Option<T>, String> {
    if path.exists() { load(path).map(Some) } else { Ok(None) }
}

fn write_normalisers(folder: &Path, version: u64) -> Result<(), String> {
    let skeleton = Skeleton::humanoid();
    let normaliser = |len: usize| {
        Normaliser::from_mean_and_deviation(&vec![version as f32; len], &vec![1.0; len])
            .expect("sound numbers")
    };
    let normalisers = Normalisers {
        observation: normaliser(skeleton.observation_len()),
        frame: normaliser(skeleton.frame_len()),
    };
    normaliser_file::save(&folder.join("normaliser.safetensors"), &normalisers).map_err(|error| told(&error))
}

fn read_normalisers(folder: &Path) -> Result<Option<u64>, String> {
    of_file(&folder.join("normaliser.safetensors"), |path| {
        let read = normaliser_file::load(path, &Skeleton::humanoid()).map_err(|error| told(&error))?;
        let (first, last) = (read.observation.mean()[0], read.frame.mean()[read.frame.len() - 1]);
        if first == last { Ok(first as u64) } else { Err(format!("{first} and {last} in one file")) }
    })
}

fn write_layout(folder: &Path, version: u64) -> Result<(), String> {
    let preset = |_| Preset { name: version.to_string(), from: "a".into(), to: "b".into(), t: [0.5; 3] };
    let layout = PanelLayout { presets: (0..300).map(preset).collect(), ..PanelLayout::default() };
    layout.save(&folder.join("layout.ron")).map_err(|error| told(&error))
}

fn read_layout(folder: &Path) -> Result<Option<u64>, String> {
    of_file(&folder.join("layout.ron"), |path| {
        let layout = PanelLayout::load(path).map_err(|error| told(&error))?;
        let last = layout.presets.last().ok_or("a layout without presets")?;
        last.name.parse().map_err(|_| format!("a preset {}", last.name))
    })
}

fn write_replay(folder: &Path, version: u64) -> Result<(), String> {
    CHARACTER.with_borrow_mut(|character| {
        let character = character.get_or_insert_with(|| {
            Character::new(&Model::from_mjcf(HUMANOID_MJCF).expect("the humanoid compiles"))
        });
        let root = character.model().skeleton().root();
        character.push(root, Vec3::X * version as f32, 1.0).map_err(|error| told(&error))?;
        character.replay_file().save(folder.join("diverged.json")).map_err(|error| told(&error))
    })
}

fn read_replay(folder: &Path) -> Result<Option<u64>, String> {
    of_file(&folder.join("diverged.json"), |path| {
        let file = ReplayFile::load(path).map_err(|error| told(&error))?;
        let json: serde_json::Value =
            serde_json::from_slice(&file.to_bytes()).map_err(|error| told(&error))?;
        json["pushes"]["forces"][0][0].as_f64().map(|force| force as u64).ok_or("no force".into())
    })
}

fn write_report(folder: &Path, version: u64) -> Result<(), String> {
    let text = serde_json::json!({ "version": version, "padding": vec![version; 3000] }).to_string();
    viewer::files::write(&folder.join("report.json"), text.as_bytes()).map_err(|error| told(&error))
}

fn read_report(folder: &Path) -> Result<Option<u64>, String> {
    of_file(&folder.join("report.json"), |path| {
        let bytes = std::fs::read(path).map_err(|error| told(&error))?;
        let json: serde_json::Value = serde_json::from_slice(&bytes).map_err(|error| told(&error))?;
        json["version"].as_u64().ok_or("no version".into())
    })
}
