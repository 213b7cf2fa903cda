//! One function for each reader: reads a file as its program does, and uses what it read.

use std::error::Error;
use std::fs;
use std::path::Path;
use std::sync::{Arc, LazyLock};

use gamepad::Script;
use gamepad::descriptor::Descriptor;
use gamepad::pads::Parser;
use gamepad::recording::{Recording, VirtualPad};
use gamepad::{Bus, PadId, PadInput};
use physics_bridge::{Character, Model, ReplayFile};
use policy_core::glam::Vec2;
use policy_core::{CharacterState, Command, Controller, ControllerState, Goal, NodeId, SkillId};
use trainer::checkpoint::Checkpoint;
use trainer::lineage::Lineage;
use trainer::pack::PackPlan;
use trainer::recipe::Recipe;
use viewer::app::PanelLayout;
use viewer::dropped::Dropped;
use viewer::pose_clip::PoseClip;

use integration_tests::{DT_SECS, HUMANOID_MJCF, reference_pack};

/// Reads one file. The error is the message that a user would see.
pub type Read = fn(&Path) -> Result<(), String>;

/// The recipes of the project.
const RECIPES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../assets/recipes");

/// All readers by name; `seeds` has sound files for each.
pub const ALL: &[(&str, Read)] = &[
    ("pack", pack),
    ("state", state),
    ("dropped", dropped),
    ("mjcf", mjcf),
    ("replay_file", replay_file),
    ("pose_clip", pose_clip),
    ("layout", layout),
    ("script", script),
    ("recording", recording),
    ("descriptor", descriptor),
    ("recipe", recipe),
    ("character", character),
    ("plan", plan),
    ("lineage", lineage),
    ("checkpoint", checkpoint),
    ("normalisers", normalisers),
    ("clip", clip),
    ("onnx", onnx),
    ("deployment", deployment),
];

/// The body of the humanoid, compiled once.
static HUMANOID: LazyLock<Model> =
    LazyLock::new(|| Model::from_mjcf(HUMANOID_MJCF).expect("the humanoid compiles"));

/// The message of an error and of its sources, as the programs print them.
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
    let pack = viewer::cli::load::pack(Some(path)).map_err(|error| format!("{error:#}"))?;
    steer(&mut Controller::new(Arc::clone(&pack)));
    // A pack brings its body and its mesh; both are opened with it.
    if pack.mjcf().is_some()
        && let Ok(model) = Model::for_pack(&pack)
    {
        let _ = viewer::appearance::of_pack(&pack, &model);
        walk_on(Character::new(&model));
    }
    Ok(())
}

/// Some ticks; their joint targets must be finite.
fn steer(controller: &mut Controller) {
    let mut state = CharacterState::new(controller.pack().skeleton());
    for tick in 0..12u8 {
        let height = f32::from(tick % 4) * 0.4;
        state.bodies.iter_mut().for_each(|body| body.position.z = height);
        let command = Command {
            target: Some(Vec2::new(2.0, height)),
            goal: Goal::Node(NodeId::new(tick.into())),
            skill: (tick % 3 == 0).then(|| SkillId::new(usize::from(tick / 3))),
            ..Command::default()
        };
        let targets = controller.tick(&state, &command, DT_SECS);
        assert!(targets.iter().all(|target| target.is_finite()), "a joint target is not finite");
    }
}

/// The bytes of a controller's state, as a saved game or another player sends them.
fn state(path: &Path) -> Result<(), String> {
    // The game knows the length, so it reads no more.
    let pack = reference_pack();
    let mut state = ControllerState::new(&pack);
    let bytes = viewer::files::read(path, state.byte_len() as u64).map_err(told)?;
    state.read_bytes(&pack, &bytes).map_err(told)?;
    let mut controller = Controller::new(pack);
    controller.restore(&state).map_err(told)?;
    steer(&mut controller);
    Ok(())
}

/// A file dropped on the window: a pack or a mesh.
fn dropped(path: &Path) -> Result<(), String> {
    match Dropped::load(path, &viewer::appearance::rig(&HUMANOID)).map_err(told)? {
        Dropped::Pack(pack) => steer(&mut Controller::new(pack)),
        Dropped::Mesh(mesh) => {
            let bodies = HUMANOID.skeleton().body_count();
            let (positions, rotations) = (vec![glam::Vec3::ZERO; bodies], vec![glam::Quat::IDENTITY; bodies]);
            mesh.palette_into(&positions, &rotations, &mut Vec::new());
        }
    }
    Ok(())
}

fn mjcf(path: &Path) -> Result<(), String> {
    let model = Model::load(path).map_err(told)?;
    walk_on(Character::new(&model));
    Ok(())
}

fn replay_file(path: &Path) -> Result<(), String> {
    walk_on(ReplayFile::load(path).map_err(told)?.to_character().map_err(told)?);
    Ok(())
}

/// A few ticks; physics may diverge.
fn walk_on(mut character: Character) {
    let mut state = CharacterState::new(character.model().skeleton());
    for _ in 0..10 {
        if character.step().is_err() {
            return;
        }
        character.sense_into(&mut state);
    }
}

fn pose_clip(path: &Path) -> Result<(), String> {
    PoseClip::load(path, HUMANOID.skeleton().joint_count() + 7).map(drop).map_err(told)
}

fn layout(path: &Path) -> Result<(), String> {
    PanelLayout::load(path).map(drop).map_err(told)
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

/// What a pad says of its reports. It comes from the system, so the file is read with a bound.
fn descriptor(path: &Path) -> Result<(), String> {
    let bytes = viewer::files::read(path, 4096).map_err(told)?;
    Descriptor::from_bytes(&bytes).map_err(told)?;
    let id = PadId { vendor: 0x1234, product: 1, bus: Bus::Other };
    let mut parser = Parser::new(id, &bytes).map_err(told)?;
    // Whether a report fits is the pad's business; it must only do no harm.
    let _ = parser.parse_into(&bytes, &mut PadInput::default());
    Ok(())
}

fn recipe(path: &Path) -> Result<(), String> {
    // A recipe names its character, whose file is in a folder beside it.
    let folder = path.parent().unwrap_or(Path::new("."));
    beside(&folder.join("characters/humanoid.toml"), &Path::new(RECIPES).join("characters/humanoid.toml"))?;
    used(&Recipe::load(path).map_err(told)?)
}

/// The file of a character, under a sound recipe.
fn character(path: &Path) -> Result<(), String> {
    let folder = path.parent().unwrap_or(Path::new(".")).join("recipes");
    beside(&folder.join("idle.toml"), &Path::new(RECIPES).join("idle.toml"))?;
    beside(&folder.join("characters/humanoid.toml"), path)?;
    used(&Recipe::load(&folder.join("idle.toml")).map_err(told)?)
}

fn used(recipe: &Recipe) -> Result<(), String> {
    let _ = (recipe.phase_at(recipe.total_samples()), recipe.first(), recipe.last());
    Ok(())
}

/// Makes `link` another name of `file`.
fn beside(link: &Path, file: &Path) -> Result<(), String> {
    let file = std::path::absolute(file).map_err(told)?;
    fs::create_dir_all(link.parent().expect("a link has a folder")).map_err(told)?;
    // It is there from the file before, or it is not.
    let _ = fs::remove_file(link);
    #[cfg(unix)]
    return std::os::unix::fs::symlink(file, link).map_err(told);
    #[cfg(not(unix))]
    return fs::copy(file, link).map(drop).map_err(told);
}

fn plan(path: &Path) -> Result<(), String> {
    PackPlan::load(path).map(drop).map_err(told)
}

fn lineage(path: &Path) -> Result<(), String> {
    Lineage::load(path).map(drop).map_err(told)
}

fn checkpoint(path: &Path) -> Result<(), String> {
    Checkpoint::load(path).map(drop).map_err(told)
}

fn normalisers(path: &Path) -> Result<(), String> {
    trainer::normaliser_file::load(path, HUMANOID.skeleton()).map(drop).map_err(told)
}

fn clip(path: &Path) -> Result<(), String> {
    clips::load_file(path).map(drop).map_err(told)
}

/// The model of a policy, on its way back into a pack.
fn onnx(path: &Path) -> Result<(), String> {
    let bytes = viewer::files::read(path, 16 << 20).map_err(told)?;
    trainer::onnx::read_policy("walk", &bytes).map(drop).map_err(told)
}

/// The file that names the models, beside sound ones.
fn deployment(path: &Path) -> Result<(), String> {
    let folder = path.parent().unwrap_or(Path::new(".")).join("onnx");
    if !folder.is_dir() {
        trainer::onnx::export(&reference_pack(), &folder).map_err(told)?;
    }
    beside(&folder.join(trainer::onnx::DEPLOYMENT_FILE), path)?;
    trainer::onnx::import(&reference_pack(), &folder).map(drop).map_err(told)
}
