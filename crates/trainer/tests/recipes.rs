//! Every recipe of the project runs two small iterations, parents before children, and all of them go into a pack.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use clips::ClipFolder;
use physics_bridge::Model;
use policy_core::{Arithmetic, CharacterPack, MlpScratch, Skeleton};
use trainer::checkpoint::Checkpoint;
use trainer::env::Normalisers;
use trainer::nn::{Network, Pass};
use trainer::pack::{PackPlan, TrainedSkill, bind};
use trainer::recipe::Recipe;
use trainer::run::{Existing, Run};
use trainer::workspace::Workspace;

fn project() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// A clip of a body that stands and sways, under any name: what clip it is doesn't matter here.
fn write_clip(folder: &Path, name: &str) {
    let frames = 25;
    let time = |i: usize| i as f32 / 24.0;
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
fn small(mut recipe: Recipe) -> Recipe {
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

#[test]
fn every_recipe_runs_and_binds_into_a_pack() {
    let folder = tempfile::tempdir().unwrap();
    let (motions, runs) = (folder.path().join("motions"), folder.path().join("runs"));
    std::fs::create_dir(&motions).unwrap();
    let recipes = project().join("assets/recipes");
    let model = Model::load(project().join("assets/humanoid.xml")).unwrap();
    for entry in std::fs::read_dir(&recipes).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "toml") {
            let recipe = Recipe::load(&path).unwrap();
            recipe.clips.iter().for_each(|clip| write_clip(&motions, &clip.name));
            recipe.first().environment.reset.clips.iter().for_each(|name| write_clip(&motions, name));
        }
    }
    let clips = ClipFolder::from_argument(Some(motions)).unwrap();
    let normalisers = Normalisers::from_clips(&[clips.load("walk").unwrap()], &model).unwrap();
    let kept = folder.path().join("kept");
    let workspace = Workspace {
        recipes,
        runs,
        kept,
        clips,
        model: model.clone(),
        normalisers: normalisers.clone(),
        parents: None,
    };

    let order = workspace.recipes_in_order().unwrap();
    let mut skills = Vec::new();
    for recipe in order {
        let recipe = small(recipe);
        let (skill, recipe_paths) = (recipe.skill.clone(), recipe.paths.clone());
        let mut run = workspace.prepare(recipe.clone(), 3, Existing::Refuse).unwrap();
        let actors = |run: &Run| -> Vec<Network> {
            let learning = run.training.learner.actors.iter().filter(|a| !a.frozen);
            learning.map(|a| a.network.clone()).collect()
        };
        let before = actors(&run);
        for _ in 0..2 {
            let report = run.advance().unwrap();
            assert!(report.style.is_finite() && report.update.kl.is_finite(), "{skill}");
        }
        let moved = actors(&run).iter().zip(&before).all(|(now, before)| now != before);
        assert!(moved, "{skill}: a policy learned nothing");
        run.save().unwrap();
        let (learned, samples, metrics) =
            (actors(&run), run.training.samples, run.folder.path().join("metrics.csv"));
        // A run holds its folder until it is dropped.
        assert!(workspace.prepare(recipe.clone(), 3, Existing::Resume).is_err(), "{skill}");
        drop(run);
        let resumed = workspace.prepare(recipe, 3, Existing::Resume).unwrap();
        assert_eq!(actors(&resumed), learned, "{skill}");
        assert_eq!(resumed.training.samples, samples, "{skill}");
        let checkpoint = workspace.checkpoint(&skill);
        match recipe_paths.is_empty() {
            true => skills.push(TrainedSkill::load(&skill, &checkpoint).unwrap()),
            // What was trained together takes the place of what was trained alone.
            false => skills
                .iter_mut()
                .filter(|i| recipe_paths.iter().flatten().any(|n| *n == i.skill))
                .for_each(|i| *i = TrainedSkill::load(&i.skill, &checkpoint).unwrap()),
        }
        let metrics = std::fs::read_to_string(metrics).unwrap();
        assert_eq!(metrics.lines().count(), 3, "{skill}");
    }

    slim_checkpoints_are_enough_to_continue(&workspace, folder.path());

    let plan = PackPlan::load(&project().join("assets/recipes/pack/humanoid.toml")).unwrap();
    let bytes = bind(&plan, &skills, &normalisers, &model, None).unwrap().to_bytes();
    let pack = Arc::new(CharacterPack::from_bytes(&bytes).unwrap());
    assert_eq!(pack.policies().len(), plan.policies.len());
    the_pack_acts_as_the_trainer(&pack, &skills);

    let partial = plan.only(|skill| skill != "jog");
    assert!(partial.paths.iter().find(|p| p.name == "speed").is_some_and(|p| p.nodes == ["idle", "walk"]));
    bind(&partial, &skills, &normalisers, &model, None).unwrap();
}

/// The slim checkpoints of the joint run and of the skill that hands over are enough to continue both, and to train a child.
fn slim_checkpoints_are_enough_to_continue(workspace: &Workspace, folder: &Path) {
    let kept = folder.join("kept_alone");
    std::fs::create_dir(&kept).unwrap();
    for skill in ["locomotion", "get_up"] {
        let slim = Checkpoint::load(&workspace.checkpoint(skill)).unwrap().slim();
        slim.save(&kept.join(format!("{skill}.safetensors"))).unwrap();
    }
    let alone = Workspace { kept, runs: folder.join("runs_alone"), ..workspace.clone() };
    for skill in ["locomotion", "get_up"] {
        let mut run = alone.prepare(small(alone.recipe(skill).unwrap()), 3, Existing::Resume).unwrap();
        run.advance().unwrap();
        assert_eq!(run.training.samples > 288, skill == "locomotion", "{skill}");
    }
    let missing = alone.prepare(small(alone.recipe("jog").unwrap()), 3, Existing::Resume);
    assert!(missing.is_ok(), "its parent was trained together with others");
}

/// Somewhere to train Walk and Idle, of clips that only sway.
fn workspace_with_clips(folder: &Path) -> Workspace {
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

#[test]
fn a_character_that_starts_in_its_clip_tracks_it_until_its_error_is_too_large() {
    let folder = tempfile::tempdir().unwrap();
    let workspace = workspace_with_clips(folder.path());
    let text = "skill = \"walk\"\nclips = [{ name = \"walk\" }]\n[[phases]]\nsamples = 100000\n\
        environment.reward = { task_weight = 0.0, tracking_weight = 1.0 }\n";
    let recipe = small(Recipe::parse(Path::new("x.toml"), text).unwrap());
    let best = best_tracking(&mut workspace.prepare(recipe, 1, Existing::Overwrite).unwrap());
    assert!((0.5..1.0).contains(&best), "{best}");
}

fn best_tracking(run: &mut Run) -> f64 {
    let each = (0..12).map(|_| {
        let episodes = run.advance().unwrap().episodes;
        episodes.tracking / episodes.ticks as f64
    });
    let best = each.fold(0.0, f64::max);
    run.save().unwrap();
    best
}

#[test]
fn trackers_track_the_clips_of_the_nodes_they_rest_at() {
    let folder = tempfile::tempdir().unwrap();
    let workspace = workspace_with_clips(folder.path());
    let recipe = |text: &str| small(Recipe::parse(Path::new("x.toml"), text).unwrap());
    let walk = "skill = \"walk\"\nclips = [{ name = \"walk\" }]\n[[phases]]\nsamples = 24\nenvironment.reward.task_weight = 0.0\n";
    let idle =
        "skill = \"idle\"\nparent = \"walk\"\nclips = [{ name = \"idle\" }]\n[[phases]]\nsamples = 24\n";
    for skill in [walk, idle] {
        let mut run = workspace.prepare(recipe(skill), 1, Existing::Overwrite).unwrap();
        run.advance().unwrap();
        run.save().unwrap();
    }
    let both = "skill = \"both\"\npaths = [[\"walk\", \"idle\"]]\n[[phases]]\nsamples = 100000\n";
    let mut all = recipe(both);
    let set = |all: &mut Recipe, share: f32| {
        let reward = &mut all.phases[0].environment.reward;
        (reward.tracking_share, reward.tracking_weight) = (share, 0.5);
    };
    all.phases[0].environment.reset.along_path = true;
    assert_eq!(best_tracking(&mut workspace.prepare(all.clone(), 1, Existing::Overwrite).unwrap()), 0.0);
    // Those that are no trackers, here nearly surely all, are neither paid for it nor fail by it.
    all.skill = "others".into();
    set(&mut all, 1e-9);
    assert_eq!(best_tracking(&mut workspace.prepare(all.clone(), 1, Existing::Overwrite).unwrap()), 0.0);
    all.skill = "again".into();
    set(&mut all, 1.0);
    let best = best_tracking(&mut workspace.prepare(all.clone(), 1, Existing::Overwrite).unwrap());
    assert!((0.3..1.0).contains(&best), "{best}");

    // Where nothing is near enough, a character that lost the clip in the first tick is not found again in the next.
    let strict = Workspace { recipes: folder.path().join("strict"), ..workspace.clone() };
    std::fs::create_dir(&strict.recipes).unwrap();
    for skill in ["walk", "idle"] {
        let mut recipe = workspace.recipe(skill).unwrap();
        recipe.phases.iter_mut().for_each(|p| p.environment.termination.max_tracking_error_metres = 1e-6);
        let path = strict.recipes.join(format!("{skill}.toml"));
        std::fs::write(path, toml::to_string(&recipe).unwrap()).unwrap();
    }
    all.skill = "strict".into();
    let mut run = strict.prepare(all, 1, Existing::Overwrite).unwrap();
    run.advance().unwrap();
    let mut mean = || {
        let reports = (0..6).map(|_| run.advance().unwrap().episodes);
        let (tracking, ticks) =
            reports.fold((0.0, 0.0), |sum, p| (sum.0 + p.tracking, sum.1 + p.ticks as f64));
        tracking / ticks
    };
    let after_the_first_ticks = mean();
    assert!(after_the_first_ticks < 0.1 * best, "{after_the_first_ticks} against {best}");
}

fn the_pack_acts_as_the_trainer(pack: &CharacterPack, skills: &[TrainedSkill]) {
    let input: Vec<f32> = (0..225).map(|i| (i as f32 * 0.7).sin()).collect();
    for (node, policy) in pack.graph().nodes().iter().zip(pack.policies()) {
        let network = &skills.iter().find(|i| i.skill == node.name).unwrap().actor;
        let mut pass = Pass::new(network.sizes(), 1);
        pass.forward(network, None, &input);
        let mut action = [0.0; 28];
        policy.evaluate_into(Arithmetic::Reproducible, &input, &mut MlpScratch::for_mlp(policy), &mut action);
        let worst = action.iter().zip(pass.output(1)).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(worst < 1e-5, "{}: {worst}", node.name);
    }
}
