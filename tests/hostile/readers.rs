//! One function for each reader: reads a file as its program does, and uses what it read.

use std::error::Error;
use std::fs;
use std::path::Path;
use std::sync::Arc;

use gamepad::Script;
use gamepad::descriptor::Descriptor;
use gamepad::pads::Parser;
use gamepad::recording::{Recording, VirtualPad};
use gamepad::{Bus, PadId, PadInput};
use physics_bridge::{Character, Dump, Model};
use policy_core::{CharacterPack, CharacterState, Command, Controller};
use trainer::checkpoint::Checkpoint;
use trainer::recipe::Recipe;
use viewer::app::Layout;

/// Reads one file. The error is the message that a user would see.
pub type Read = fn(&Path) -> Result<(), String>;

/// All readers by name; `seeds` has sound files for each.
pub const ALL: &[(&str, Read)] = &[
    ("pack", pack),
    ("mesh", mesh),
    ("mjcf", mjcf),
    ("dump", dump),
    ("poses", poses),
    ("layout", layout),
    ("script", script),
    ("recording", recording),
    ("descriptor", descriptor),
    ("recipe", recipe),
    ("plan", plan),
    ("checkpoint", checkpoint),
    ("normalisers", normalisers),
    ("clip", clip),
];

/// The message of an error and of those below it, as the programs print them.
fn told(error: impl Error) -> String {
    let mut message = error.to_string();
    let mut source = error.source();
    while let Some(cause) = source {
        message.push_str(": ");
        message.push_str(&cause.to_string());
        source = cause.source();
    }
    message
}

fn pack(path: &Path) -> Result<(), String> {
    let bytes = fs::read(path).map_err(told)?;
    let pack = Arc::new(CharacterPack::from_bytes(&bytes).map_err(told)?);
    let state = CharacterState::default();
    let mut controller = Controller::new(Arc::clone(&pack));
    for skill in [None].into_iter().chain((0..pack.skills().len().min(8)).map(Some)) {
        let command = Command { skill, ..Command::default() };
        for _ in 0..5 {
            let targets = controller.tick(&state, &command, 1.0 / 30.0);
            assert!(targets.0.iter().all(|target| target.is_finite()), "a joint target is not finite");
        }
    }
    Ok(())
}

fn mesh(path: &Path) -> Result<(), String> {
    let mesh = viewer::mesh::SkinnedMesh::load(path).map_err(told)?;
    let positions = [glam::Vec3::ZERO; 15];
    mesh.palette_into(&positions, &[glam::Quat::IDENTITY; 15], &mut Vec::new());
    Ok(())
}

fn mjcf(path: &Path) -> Result<(), String> {
    let model = Model::load(path).map_err(told)?;
    walk_on(Character::new(&model));
    Ok(())
}

fn dump(path: &Path) -> Result<(), String> {
    walk_on(Dump::load(path).map_err(told)?.to_character().map_err(told)?);
    Ok(())
}

/// A few ticks; physics may diverge.
fn walk_on(mut character: Character) {
    let mut state = CharacterState::default();
    for _ in 0..10 {
        if character.step().is_err() {
            return;
        }
        character.sense_into(&mut state);
    }
}

fn poses(path: &Path) -> Result<(), String> {
    viewer::poses::Poses::load(path).map(drop).map_err(told)
}

fn layout(path: &Path) -> Result<(), String> {
    Layout::load(path).map(drop).map_err(told)
}

fn script(path: &Path) -> Result<(), String> {
    let script = Script::load(path).map_err(told)?;
    for time_secs in [-1.0, 0.0, 1.0, script.duration() * 0.5, script.duration(), f64::INFINITY] {
        let _ = script.state_at(time_secs);
    }
    Ok(())
}

fn recording(path: &Path) -> Result<(), String> {
    let recording = Recording::load(path).map_err(told)?;
    let duration = recording.duration();
    let mut pad = VirtualPad::new(recording).map_err(told)?;
    for step in 0..20 {
        pad.report_at(duration * f64::from(step) / 20.0);
    }
    Ok(())
}

fn descriptor(path: &Path) -> Result<(), String> {
    let bytes = fs::read(path).map_err(told)?;
    Descriptor::from_bytes(&bytes).map_err(told)?;
    let id = PadId { vendor: 0x1234, product: 1, bus: Bus::Other };
    let mut parser = Parser::new(id, &bytes).map_err(told)?;
    // Whether a report fits is the pad's business; it must only do no harm.
    let _ = parser.parse_into(&bytes, &mut PadInput::default());
    Ok(())
}

fn recipe(path: &Path) -> Result<(), String> {
    let recipe = Recipe::load(path).map_err(told)?;
    let _ = recipe.environment_at(recipe.total_samples());
    Ok(())
}

fn plan(path: &Path) -> Result<(), String> {
    trainer::pack::PackPlan::load(path).map(drop).map_err(told)
}

fn checkpoint(path: &Path) -> Result<(), String> {
    Checkpoint::load(path).map(drop).map_err(told)
}

fn normalisers(path: &Path) -> Result<(), String> {
    trainer::normaliser_file::load(path).map(drop).map_err(told)
}

fn clip(path: &Path) -> Result<(), String> {
    trainer::clip::load_file(path).map(drop).map_err(told)
}
