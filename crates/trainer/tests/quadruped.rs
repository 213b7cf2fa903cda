//! A second skeleton, with four legs and hips of two hinges, through clip, training and pack.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use clips::{ClipFolder, fit};
use physics_bridge::{Character, Model};
use policy_core::{CharacterPack, Command, Controller};
use trainer::env::Normalisers;
use trainer::pack::{PackPlan, TrainedSkill, bind};
use trainer::recipe::Recipe;
use trainer::run::Existing;
use trainer::workspace::Workspace;

const RECIPE: &str = r#"
skill = "trot"
clips = [{ name = "trot" }]

[[phases]]
samples = 24
environment.reward.tracking_weight = 0.4
ppo.behaviour_cloning = 10.0

[[phases]]
samples = 100_000
environment.randomisation = { push_secs = 0.2, push_newton = 20.0, push_bodies = ["trunk", "head"] }

[environment]
num_envs = 6
horizon = 4
command.speed_mps = 0.5
reward.standing_root_metres = 0.36
termination = { min_heights = { trunk = 0.1, head = 0.1 }, fall_metres = 0.15, lying_metres = 0.1 }
reset = { limp_share = 0.2 }

[ppo]
epochs = 1
minibatch = 12
critic_hidden = [16]

[discriminator]
hidden = [16]
batch = 8
updates = 1
replay_size = 64
"#;

const PLAN: &str = r#"
character = "quadruped"
policies = [{ name = "trot", fall_height = 0.15, speed_mps = 0.5 }]
"#;

fn asset(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/assets").join(name)
}

/// A clip of the quadruped in which each leg swings about its hip, half a metre a second.
fn write_clip(folder: &Path, model: &Model) {
    let skeleton = model.skeleton();
    let time = |i: usize| i as f32 / 30.0;
    let rotation = |name: &str, i: usize| {
        let swing = 0.25 * (std::f32::consts::TAU * 1.25 * time(i)).sin();
        let half = match (name.ends_with("thigh"), name.contains("left")) {
            (true, true) => 0.5 * swing,
            (true, false) => -0.5 * swing,
            _ => 0.0,
        };
        [0.0, half.sin(), 0.0, half.cos()]
    };
    let frames = 25;
    let names: Vec<&str> = skeleton.bodies().iter().map(|body| body.name.as_str()).collect();
    let text = serde_json::json!({
        "loop": "wrap", "bodies": names, "times": (0..frames).map(time).collect::<Vec<_>>(),
        "root_pos": (0..frames).map(|i| [0.5 * time(i), 0.0, 0.4]).collect::<Vec<_>>(),
        "local_rot": (0..frames)
            .map(|i| names.iter().map(|name| rotation(name, i)).collect::<Vec<_>>())
            .collect::<Vec<_>>(),
    });
    std::fs::write(folder.join("trot.json"), text.to_string()).unwrap();
}

#[test]
fn a_quadruped_is_trained_and_bound() {
    let folder = tempfile::tempdir().unwrap();
    let model = Model::load(asset("quadruped.xml")).unwrap();
    let skeleton = model.skeleton().clone();
    assert_ne!((skeleton.body_count(), skeleton.joint_count()), (15, 28));
    write_clip(folder.path(), &model);
    let clips = ClipFolder::from_argument(Some(folder.path().to_owned())).unwrap();
    let clip = clips.load("trot").unwrap();
    let fitted = fit(&clip, &model).unwrap();
    assert!(fitted.motion.outside_limits.0 < 1e-3, "{:?}", fitted.motion.outside_limits);
    let hip = skeleton.joint_named("front_left_hip_y").unwrap().index();
    let widest = fitted.motion.poses.iter().map(|pose| pose.qpos[7 + hip].abs()).fold(0.0, f64::max);
    assert!((widest - 0.25).abs() < 0.02, "{widest}");
    let normalisers = Normalisers::from_clips(&[clip], &model).unwrap();

    let workspace = Workspace {
        recipes: folder.path().join("recipes"),
        runs: folder.path().join("runs"),
        kept: folder.path().join("kept"),
        clips,
        model: model.clone(),
        normalisers: normalisers.clone(),
        parents: None,
    };
    let recipe = Recipe::parse(Path::new("trot.toml"), RECIPE).unwrap();
    let mut run = workspace.prepare(recipe, Some(1), Existing::Refuse).unwrap();
    let before = run.training.learner.actor().clone();
    for _ in 0..2 {
        let report = run.advance().unwrap();
        assert!(report.reward.is_finite() && report.update.kl.is_finite());
    }
    assert_ne!(run.training.learner.actor(), &before, "the policy learned nothing");
    run.save().unwrap();

    let skill = TrainedSkill::load("trot", &workspace.checkpoint("trot")).unwrap();
    let plan = folder.path().join("plan.toml");
    std::fs::write(&plan, PLAN).unwrap();
    let pack = bind(&PackPlan::load(&plan).unwrap(), &[skill], &normalisers, &model, None).unwrap();
    let pack = Arc::new(CharacterPack::from_bytes(&pack.to_bytes()).unwrap());
    assert_eq!(pack.skeleton().as_ref(), skeleton.as_ref());
    // The pack holds its body: nothing else is needed to move it.
    let model = Model::for_pack(&pack).unwrap();
    let (mut character, mut controller) = (Character::new(&model), Controller::new(pack.clone()));
    for _ in 0..10 {
        character.control_tick(&mut controller, &Command::default(), 1.0 / pack.control_hz()).unwrap();
        assert_eq!(controller.report().fault, None);
    }
}
