use std::path::Path;

use clips::ClipFolder;
use policy_core::{BodyId, NodeId, PathId};

use super::*;
use crate::run::{Existing, Run};
use crate::workspace::{Start, Workspace};

/// What the recipes of these tests share.
const SMALL: &str = r#"
[environment]
num_envs = 4
horizon = 4
[ppo]
epochs = 1
minibatch = 8
critic_hidden = [8]
[discriminator]
hidden = [8]
batch = 4
updates = 1
replay_size = 32
"#;

/// Samples of an iteration.
const ROWS: u64 = 16;

/// A workspace with a clip in which the humanoid stands with its root 0.9 m up.
fn workspace(folder: &Path) -> Workspace {
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets");
    let model = Model::load(assets.join("humanoid.xml")).unwrap();
    let bodies: Vec<_> = model.skeleton().bodies().iter().map(|body| body.name.clone()).collect();
    let clip = serde_json::json!({
        "loop": "none", "times": (0..30).map(|i| i as f32 / 30.0).collect::<Vec<_>>(),
        "root_pos": vec![[0.0, 0.0, 0.9]; 30],
        "local_rot": vec![vec![[0.0, 0.0, 0.0, 1.0]; bodies.len()]; 30], "bodies": bodies,
    });
    std::fs::write(folder.join("stand.json"), clip.to_string()).unwrap();
    let clips = ClipFolder::from_argument(Some(folder.to_owned())).unwrap();
    let normalisers = Normalisers::from_clips(&[clips.load("stand").unwrap()], &model).unwrap();
    let [recipes, runs, kept] = ["recipes", "runs", "kept"].map(|name| folder.join(name));
    Workspace { recipes, runs, kept, clips, model, normalisers, parents: None }
}

fn recipe(skill: &str, more: &str, phases: &str) -> Recipe {
    let text = format!("skill = \"{skill}\"\nclips = [{{ name = \"stand\" }}]\n{more}\n{phases}\n{SMALL}");
    Recipe::parse(Path::new("x.toml"), &text).unwrap()
}

/// The training of a recipe, in the phase after so many samples.
fn training(workspace: &Workspace, recipe: &Recipe, seed: u64, samples: u64) -> Training {
    let parts = workspace.parts(recipe, seed).unwrap();
    let mut training =
        Training::new(recipe.clone(), &workspace.model, workspace.normalisers.clone(), parts, seed);
    training.samples = samples;
    training.enter_phase().unwrap();
    training
}

fn pushed(training: &Training) -> Vec<BodyId> {
    training.shared.bodies[training.shared.phase].pushed.clone()
}

const TWO_PHASES: &str = r#"
[[phases]]
samples = 16
ppo.learning_rate = 1e-4
[[phases]]
samples = 16
ppo.learning_rate = 2e-4
environment.command = { edge_secs = 3.0, speed_mps = 1.0 }
environment.termination.standing_metres = 0.5
environment.randomisation = { push_bodies = ["torso", "head"], dynamics = 0.2, long_steps = true }
"#;

#[test]
fn a_node_knows_the_height_of_its_clips_in_every_phase() {
    let folder = tempfile::tempdir().unwrap();
    let workspace = workspace(folder.path());
    let recipe = recipe("walk", "", TWO_PHASES);
    for samples in [0, ROWS] {
        let training = training(&workspace, &recipe, 1, samples);
        let metres = training.graph().nodes()[0].root_metres;
        assert!((0.8..1.0).contains(&metres), "{metres} m after {samples} samples");
    }
}

#[test]
fn a_phase_sets_up_all_that_it_overlays() {
    let folder = tempfile::tempdir().unwrap();
    let workspace = workspace(folder.path());
    let recipe = recipe("walk", "", TWO_PHASES);
    let mut training = training(&workspace, &recipe, 1, 0);
    let root = workspace.model.skeleton().root();
    assert_eq!(pushed(&training), [root]);
    let before = training.shared.bodies[0].heights.clone();
    training.iterate().unwrap();
    training.enter_phase().unwrap();
    assert_eq!(pushed(&training).len(), 2);
    assert!(!pushed(&training).contains(&root));
    assert_ne!(training.shared.bodies[training.shared.phase].heights, before);
    assert_eq!(training.learner.actors[0].learning_rate, 2e-4);
    let mut coarse = recipe.last().environment.clone();
    coarse.randomisation.long_steps = false;
    assert_ne!(models_of(&coarse), models_of(&recipe.last().environment));
}

#[test]
fn the_seconds_of_an_edge_are_those_of_the_phase() {
    let folder = tempfile::tempdir().unwrap();
    let workspace = workspace(folder.path());
    let parent = recipe("walk", "", "[[phases]]\nsamples = 16");
    std::fs::create_dir(&workspace.recipes).unwrap();
    std::fs::write(workspace.recipes.join("walk.toml"), toml::to_string(&parent).unwrap()).unwrap();
    let mut run = workspace.prepare(parent, None, Existing::Refuse).unwrap();
    run.save().unwrap();
    drop(run);
    let child = recipe("jog", "parent = \"walk\"\nedge = true", TWO_PHASES);
    let secs = [0, ROWS].map(|samples| {
        let training = training(&workspace, &child, 1, samples);
        let graph = training.graph();
        assert_eq!(graph.end(PathId::new(0)), 1.0);
        let [walk, jog] = [0, 1].map(NodeId::new);
        graph.policy_graph().edge_between(walk, jog).unwrap().seconds_from(walk)
    });
    assert!(secs[1] == 3.0 && secs[0] < 3.0, "{secs:?}");
}

#[test]
fn the_seed_reaches_the_environments_of_every_phase() {
    let folder = tempfile::tempdir().unwrap();
    let workspace = workspace(folder.path());
    let randomised = "[[phases]]\nsamples = 16\nenvironment.randomisation.dynamics = 0.2";
    let recipe = recipe("walk", "", randomised);
    let inputs = |seed| training(&workspace, &recipe, seed, 0).envs.inputs;
    assert_eq!(inputs(1), inputs(1));
    assert_ne!(inputs(1), inputs(2));
}

#[test]
fn a_run_continues_with_its_seed_and_rates_and_another_begins_with_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let workspace = workspace(folder.path());
    let walk = recipe("walk", "", "[[phases]]\nsamples = 160\nppo.learning_rate = 1e-4");
    let mut run = workspace.prepare(walk.clone(), Some(7), Existing::Refuse).unwrap();
    run.training.learner.actors[0].learning_rate = 3e-5;
    run.training.learner.rng.normal();
    let rng = run.training.learner.rng;
    run.save().unwrap();
    drop(run);

    let resumed = workspace.prepare(walk.clone(), None, Existing::Resume).unwrap();
    assert_eq!((resumed.seed, resumed.training.learner.rng), (7, rng));
    assert_eq!(resumed.training.learner.actors[0].learning_rate, 3e-5);
    drop(resumed);
    let given = workspace.prepare(walk.clone(), Some(8), Existing::Resume).unwrap();
    assert_eq!(given.seed, 8);
    drop(given);

    let checkpoint = workspace.required("walk").unwrap();
    let start = Start::From { checkpoint, samples: 0 };
    let other = workspace.prepare_named("other", walk, None, Existing::Refuse, start).unwrap();
    assert_eq!((other.seed, other.training.learner.actors[0].learning_rate), (1, 1e-4));
    assert_ne!(other.training.learner.rng, rng, "the random numbers of its own seed");
}

#[test]
fn a_teacher_is_the_policy_that_its_phase_began_with_and_a_resumed_run_has_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let workspace = workspace(folder.path());
    let symmetrised =
        "[[phases]]\nsamples = 16\n\n[[phases]]\nsamples = 32\nppo.symmetry = 1.0\nppo.symmetrise = true";
    let walk = recipe("walk", "", symmetrised);
    let mut run = workspace.prepare(walk.clone(), None, Existing::Refuse).unwrap();
    run.advance().unwrap();
    assert!(run.training.learner.teacher.is_none());
    let began_with = run.training.learner.actor().clone();
    run.advance().unwrap();
    assert_ne!(*run.training.learner.actor(), began_with);
    assert_eq!(run.training.learner.teacher.as_ref(), Some(&began_with));
    run.save().unwrap();
    drop(run);

    let mut resumed = workspace.prepare(walk, None, Existing::Resume).unwrap();
    resumed.advance().unwrap();
    assert_eq!(resumed.training.learner.teacher, Some(began_with));
    assert!(!workspace.required("walk").unwrap().0.slim().networks.contains_key(TEACHER));
}

/// A run of one iteration that was saved.
fn saved_run(workspace: &Workspace, recipe: &Recipe) -> Run {
    let mut run = workspace.prepare(recipe.clone(), None, Existing::Refuse).unwrap();
    run.advance().unwrap();
    run.save().unwrap();
    run
}

#[test]
fn a_run_is_deleted_once_the_new_one_is_ready() {
    let folder = tempfile::tempdir().unwrap();
    let workspace = workspace(folder.path());
    let walk = recipe("walk", "", "[[phases]]\nsamples = 160");
    drop(saved_run(&workspace, &walk));
    let mut larger = walk.clone();
    larger.phases[0].ppo.critic_hidden = vec![12];
    let path = workspace.checkpoint("walk");
    let sizes = workspace.prepare_from("walk", 0, larger, None, Existing::Overwrite).unwrap_err();
    assert!(sizes.to_string().contains("critic"), "{sizes}");
    assert!(path.exists(), "the old run is lost");
    drop(workspace.prepare_from("walk", 0, walk, None, Existing::Overwrite).unwrap());
    assert!(!path.exists());
}

#[test]
fn a_run_that_begins_by_itself_does_not_continue_a_kept_checkpoint() {
    let folder = tempfile::tempdir().unwrap();
    let workspace = workspace(folder.path());
    let walk = recipe("walk", "", "[[phases]]\nsamples = 160");
    drop(saved_run(&workspace, &walk));
    std::fs::create_dir(&workspace.kept).unwrap();
    std::fs::rename(workspace.checkpoint("walk"), workspace.kept.join("walk.safetensors")).unwrap();
    let samples = || workspace.prepare(walk.clone(), None, Existing::Resume).unwrap().training.samples;
    assert_eq!(samples(), 0, "it began by itself");
    std::fs::remove_dir_all(workspace.runs.join("walk")).unwrap();
    assert_eq!(samples(), ROWS);
    assert_eq!(samples(), ROWS, "it continues the kept one until it has its own");
}

#[test]
fn metrics_do_not_go_back_in_time_after_a_kill() {
    let folder = tempfile::tempdir().unwrap();
    let workspace = workspace(folder.path());
    let walk = recipe("walk", "", "[[phases]]\nsamples = 160");
    let mut run = saved_run(&workspace, &walk);
    run.advance().unwrap();
    drop(run);
    let mut run = workspace.prepare(walk, None, Existing::Resume).unwrap();
    run.advance().unwrap();
    let text = std::fs::read_to_string(run.folder.path().join("metrics.csv")).unwrap();
    let samples: Vec<_> = text.lines().skip(1).map(|row| row.split(',').next().unwrap()).collect();
    assert_eq!(samples, ["16", "32"]);
}

#[test]
fn a_discriminator_that_is_no_longer_finite_ends_the_run_before_it_is_saved() {
    let folder = tempfile::tempdir().unwrap();
    let workspace = workspace(folder.path());
    let walk = recipe("walk", "", "[[phases]]\nsamples = 16");
    let mut run = workspace.prepare(walk, None, Existing::Refuse).unwrap();
    let discriminator = run.training.discriminators.scorers[0].discriminator.as_mut().unwrap();
    discriminator.network.parameters[0] = f32::NAN;
    let error = run.advance().unwrap_err().to_string();
    assert!(error.contains("discriminator"), "{error}");
    assert!(!workspace.checkpoint("walk").exists());
}
