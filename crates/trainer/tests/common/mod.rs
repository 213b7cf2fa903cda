//! Clips that only sway, small recipes, and a workspace to train them in.
#![allow(dead_code, reason = "each test file uses a part")]

use std::path::{Path, PathBuf};

use clips::ClipFolder;
use physics_bridge::Model;
use policy_core::Skeleton;
use trainer::env::Normalisers;
use trainer::recipe::Recipe;
use trainer::workspace::Workspace;

/// The root of the repository.
pub fn project() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// A clip of a body that stands and sways, under any name: what clip it is doesn't matter here.
pub fn write_clip(folder: &Path, name: &str) {
    let frames = 121;
    let time = |i: usize| i as f32 / 60.0;
    let sway = |i: usize| (std::f32::consts::TAU * time(i)).sin();
    let rotations = |i: usize| {
        let mut all = vec![[0.0, 0.0, 0.0, 1.0]; 15];
        let half = 0.1 * sway(i);
        all[1] = [0.0, half.sin(), 0.0, half.cos()];
        all
    };
    let text = serde_json::json!({
        "loop": "wrap", "bodies": Skeleton::humanoid().bodies().iter().map(|b| b.name.clone()).collect::<Vec<_>>(), "times": (0..frames).map(time).collect::<Vec<_>>(),
        "root_pos": (0..frames).map(|i| [0.5 * time(i), 0.0, 0.9]).collect::<Vec<_>>(),
        "local_rot": (0..frames).map(rotations).collect::<Vec<_>>(),
    });
    std::fs::write(folder.join(format!("{name}.json")), text.to_string()).unwrap();
}

/// The recipe with everything that costs time made small.
pub fn small(mut recipe: Recipe) -> Recipe {
    // Where skills are trained together, enough characters that some act as each of them.
    let num_envs = if recipe.paths.is_empty() { 6 } else { 36 };
    for phase in &mut recipe.phases {
        (phase.environment.num_envs, phase.environment.horizon) = (num_envs, 4);
        (phase.ppo.epochs, phase.ppo.minibatch) = (1, 12);
        phase.ppo.critic_hidden = vec![16];
        phase.discriminator.hidden = vec![16, 8];
        (phase.discriminator.batch, phase.discriminator.updates) = (8, 1);
        phase.discriminator.replay_size = 64;
    }
    recipe
}

/// Somewhere to train Walk and Idle, of clips that only sway.
pub fn workspace_with_clips(folder: &Path) -> Workspace {
    write_clip(folder, "walk");
    write_clip(folder, "idle");
    let model = Model::load(project().join("assets/humanoid.xml")).unwrap();
    let clips = ClipFolder::from_argument(Some(folder.to_owned())).unwrap();
    let normalisers = Normalisers::from_clips(&[clips.load("walk").unwrap()], &model).unwrap();
    Workspace {
        recipes: project().join("assets/recipes"),
        runs: folder.join("runs"),
        kept: folder.join("kept"),
        clips,
        model,
        normalisers,
        parents: None,
    }
}
