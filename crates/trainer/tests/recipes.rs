//! Every recipe of the project runs two small iterations, parents before children, and all of them go into a pack.

mod common;

use std::path::Path;
use std::sync::Arc;

use clips::ClipFolder;
use common::{project, small, write_clip};
use physics_bridge::Model;
use policy_core::{Arithmetic, CharacterPack, MlpScratch};
use trainer::checkpoint::Checkpoint;
use trainer::env::{Normalisers, OutOf, RUNS_MPS};
use trainer::nn::{Network, Pass};
use trainer::pack::{PackPlan, PlannedPolicy, TrainedSkill, bind};
use trainer::recipe::Recipe;
use trainer::run::{Existing, Run};
use trainer::workspace::Workspace;

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
        let mut run = workspace.prepare(recipe.clone(), Some(3), Existing::Refuse).unwrap();
        let actors = |run: &Run| -> Vec<Network> {
            let learning = run.training.learner.actors.iter().filter(|a| !a.frozen);
            learning.map(|a| a.network.clone()).collect()
        };
        let before = actors(&run);
        if let Some(original) = &run.training.recipe.variant_of {
            let original = Checkpoint::load(&workspace.checkpoint(original)).unwrap();
            assert_eq!(
                before,
                [original.networks["actor"].network.clone()],
                "{skill} starts from its original"
            );
        }
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
        assert!(workspace.prepare(recipe.clone(), Some(3), Existing::Resume).is_err(), "{skill}");
        drop(run);
        let resumed = workspace.prepare(recipe, Some(3), Existing::Resume).unwrap();
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
    for planned in &plan.policies {
        let PlannedPolicy { name, skill: Some(skill), .. } = planned else { continue };
        let other = skills.iter().find(|trained| trained.skill == *skill).unwrap();
        skills.push(TrainedSkill { skill: name.clone(), ..other.clone() });
    }
    let bytes = bind(&plan, &skills, &normalisers, &model, None).unwrap().to_bytes();
    let pack = Arc::new(CharacterPack::from_bytes(&bytes).unwrap());
    assert_eq!(pack.policies().len(), plan.policies.len());
    the_pack_acts_as_the_trainer(&pack, &skills);

    let partial = plan.only(|skill| skill != "jog");
    assert!(partial.paths.iter().find(|p| p.name == "speed").is_some_and(|p| p.nodes == ["idle", "walk"]));
    bind(&partial, &skills, &normalisers, &model, None).unwrap();
}

/// A policy that learned with one clock and is shown another one would do its skill too fast or too slowly.
#[test]
fn a_timed_skill_has_the_clock_of_its_recipe() {
    let recipes = project().join("assets/recipes");
    let plan = PackPlan::load(&recipes.join("pack/humanoid.toml")).unwrap();
    let mut timed = 0;
    for skill in &plan.skills {
        let recipe = Recipe::load(&recipes.join(format!("{}.toml", skill.policy))).unwrap();
        for phase in &recipe.phases {
            let learned = phase.environment.command.clock_seconds;
            assert_eq!(learned, skill.clock_seconds.unwrap_or(0.0), "{}", skill.name);
            let starts = phase.environment.reset.in_play.and_then(|start| start.maximum_speed_mps);
            let most = skill.maximum_speed_mps.unwrap_or(f32::INFINITY);
            // One that starts at a footfall is as fast as its gait: see below.
            assert!(
                skill.on_footfall || starts.is_none_or(|learned| most <= learned),
                "{} starts faster than it learned",
                skill.name
            );
            let runs = phase.environment.reset.in_play.is_some_and(|start| start.out_of == OutOf::Run);
            assert!(!runs || skill.minimum_speed_mps == RUNS_MPS, "{}", skill.name);
        }
        let last = recipe.phases.last().and_then(|phase| phase.environment.reset.in_play);
        if let Some(learned) = last.and_then(|start| start.maximum_speed_mps).filter(|_| skill.on_footfall) {
            let starts_from = |gait: &&PlannedPolicy| skill.entry.contains(&gait.name);
            let speeds = plan.policies.iter().filter(starts_from).filter_map(|gait| gait.speed_mps);
            let slowest = speeds.fold(f32::INFINITY, f32::min);
            assert!(slowest <= learned, "{} has not learned its slowest gait", skill.name);
        }
        timed += usize::from(skill.clock_seconds.is_some());
    }
    assert!(timed >= 1, "a jump");
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
        let mut run = alone.prepare(small(alone.recipe(skill).unwrap()), Some(3), Existing::Resume).unwrap();
        run.advance().unwrap();
        assert_eq!(run.training.samples > 288, skill == "locomotion", "{skill}");
    }
    let missing = alone.prepare(small(alone.recipe("jog").unwrap()), Some(3), Existing::Resume);
    assert!(missing.is_ok(), "its parent was trained together with others");
    drop(missing);

    let jog = || small(alone.recipe("jog").unwrap());
    let run = alone.prepare_from("locomotion", 7, jog(), Some(3), Existing::Overwrite).unwrap();
    let joint = Checkpoint::load(&alone.kept.join("locomotion.safetensors")).unwrap();
    assert_eq!(run.training.learner.actors[1].network, joint.networks["jog.actor"].network);
    assert_eq!(run.training.samples, 7, "a run of its own");
    drop(run);
    let unknown =
        alone.prepare_from("gallop", 0, jog(), Some(3), Existing::Overwrite).unwrap_err().to_string();
    assert!(unknown.contains("named gallop") && unknown.contains("kept_alone"), "{unknown}");
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
