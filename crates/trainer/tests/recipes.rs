//! Every recipe of the project through two small iterations, parents before children, and all of them into a pack.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use physics_bridge::Model;
use policy_core::{Arithmetic, BODY_NAMES, CharacterPack, DOF_COUNT, MlpScratch, POLICY_INPUT_LEN};
use trainer::checkpoint::Checkpoint;
use trainer::clip::ClipFolder;
use trainer::env::Normalisers;
use trainer::nn::{Network, Pass};
use trainer::pack::{Ingredient, PackPlan, bind};
use trainer::recipe::Recipe;
use trainer::run::{Existing, Run};
use trainer::workplace::Workplace;

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
        "loop": "wrap", "bodies": BODY_NAMES, "times": (0..frames).map(time).collect::<Vec<_>>(),
        "root_pos": (0..frames).map(|i| [0.5 * time(i), 0.0, 0.9]).collect::<Vec<_>>(),
        "local_rot": (0..frames).map(rotations).collect::<Vec<_>>(),
    });
    std::fs::write(folder.join(format!("{name}.json")), text.to_string()).unwrap();
}

/// The recipe with everything that costs time made small.
fn small(mut recipe: Recipe) -> Recipe {
    // Where skills are trained together, enough characters that some act as each of them.
    let characters = if recipe.paths.is_empty() { 6 } else { 36 };
    (recipe.environment.characters, recipe.environment.steps) = (characters, 4);
    (recipe.ppo.epochs, recipe.ppo.minibatch) = (1, 12);
    recipe.ppo.critic_hidden = vec![16];
    recipe.discriminator.hidden = vec![16, 8];
    (recipe.discriminator.rows, recipe.discriminator.updates) = (8, 1);
    (recipe.discriminator.replay, recipe.discriminator.replay_rows) = (64, 8);
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
            recipe.environment.start.clips.iter().for_each(|name| write_clip(&motions, name));
        }
    }
    let clips = ClipFolder::from_argument(Some(motions)).unwrap();
    let normalisers = Normalisers::from_clips(&[clips.load("walk").unwrap()], &model).unwrap();
    let kept = folder.path().join("kept");
    let workplace =
        Workplace { recipes, runs, kept, clips, model: model.clone(), normalisers: normalisers.clone() };

    let order = workplace.recipes_in_order().unwrap();
    let mut ingredients = Vec::new();
    for recipe in order {
        let recipe = small(recipe);
        let (skill, recipe_paths) = (recipe.skill.clone(), recipe.paths.clone());
        let mut run = workplace.prepare(recipe.clone(), 3, Existing::Refuse).unwrap();
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
        assert!(workplace.prepare(recipe.clone(), 3, Existing::Resume).is_err(), "{skill}");
        drop(run);
        let resumed = workplace.prepare(recipe, 3, Existing::Resume).unwrap();
        assert_eq!(actors(&resumed), learned, "{skill}");
        assert_eq!(resumed.training.samples, samples, "{skill}");
        let checkpoint = workplace.checkpoint(&skill);
        match recipe_paths.is_empty() {
            true => ingredients.push(Ingredient::load(&skill, &checkpoint).unwrap()),
            // What was trained together takes the place of what was trained alone.
            false => ingredients
                .iter_mut()
                .filter(|i| recipe_paths.iter().flatten().any(|n| *n == i.skill))
                .for_each(|i| *i = Ingredient::load(&i.skill, &checkpoint).unwrap()),
        }
        let metrics = std::fs::read_to_string(metrics).unwrap();
        assert_eq!(metrics.lines().count(), 3, "{skill}");
    }

    what_was_kept_is_enough_to_go_on(&workplace, folder.path());

    let plan = PackPlan::load(&project().join("assets/recipes/pack/humanoid.toml")).unwrap();
    let bytes = bind(&plan, &ingredients, &normalisers, &model).unwrap().to_bytes();
    let pack = Arc::new(CharacterPack::from_bytes(&bytes).unwrap());
    assert_eq!(pack.policies().len(), plan.policies.len());
    the_pack_acts_as_the_trainer(&pack, &ingredients);

    let partial = plan.only(|skill| skill != "jog");
    assert!(partial.paths.iter().find(|p| p.name == "speed").is_some_and(|p| p.nodes == ["idle", "walk"]));
    bind(&partial, &ingredients, &normalisers, &model).unwrap();
}

/// From the slim checkpoints of the joint run and of what it starts after alone, all of it goes on, and so does a child of one of its skills.
fn what_was_kept_is_enough_to_go_on(workplace: &Workplace, folder: &Path) {
    let kept = folder.join("kept_alone");
    std::fs::create_dir(&kept).unwrap();
    for skill in ["locomotion", "get_up"] {
        let slim = Checkpoint::load(&workplace.checkpoint(skill)).unwrap().slim();
        slim.save(&kept.join(format!("{skill}.safetensors"))).unwrap();
    }
    let alone = Workplace { kept, runs: folder.join("runs_alone"), ..workplace.clone() };
    for skill in ["locomotion", "get_up"] {
        let mut run = alone.prepare(small(alone.recipe(skill).unwrap()), 3, Existing::Resume).unwrap();
        run.advance().unwrap();
        assert_eq!(run.training.samples > 288, skill == "locomotion", "{skill}");
    }
    let missing = alone.prepare(small(alone.recipe("jog").unwrap()), 3, Existing::Resume);
    assert!(missing.is_ok(), "its parent was trained together with others");
}

/// Somewhere to train Walk and Idle, of clips that only sway.
fn workplace_with_clips(folder: &Path) -> Workplace {
    write_clip(folder, "walk");
    write_clip(folder, "idle");
    let model = Model::load(project().join("assets/humanoid.xml")).unwrap();
    let clips = ClipFolder::from_argument(Some(folder.to_owned())).unwrap();
    let normalisers = Normalisers::from_clips(&[clips.load("walk").unwrap()], &model).unwrap();
    Workplace {
        recipes: project().join("assets/recipes"),
        runs: folder.join("runs"),
        kept: folder.join("kept"),
        clips,
        model,
        normalisers,
    }
}

#[test]
fn a_character_that_starts_in_its_clip_is_like_it_until_it_loses_it() {
    let folder = tempfile::tempdir().unwrap();
    let workplace = workplace_with_clips(folder.path());
    let text = "skill = \"walk\"\nclips = [{ name = \"walk\" }]\n[[phases]]\nsamples = 100000\ntask = 0.0\nimitation = 1.0\n";
    let recipe = small(Recipe::parse(Path::new("x.toml"), text).unwrap());
    let best = best_imitation(&mut workplace.prepare(recipe, 1, Existing::Overwrite).unwrap());
    assert!((0.5..1.0).contains(&best), "{best}");
}

fn best_imitation(run: &mut Run) -> f64 {
    let each = (0..12).map(|_| {
        let population = run.advance().unwrap().population;
        population.imitation / population.ticks as f64
    });
    let best = each.fold(0.0, f64::max);
    run.save().unwrap();
    best
}

#[test]
fn imitators_are_like_the_clips_of_the_nodes_they_rest_at() {
    let folder = tempfile::tempdir().unwrap();
    let workplace = workplace_with_clips(folder.path());
    let recipe = |text: &str| small(Recipe::parse(Path::new("x.toml"), text).unwrap());
    let walk = "skill = \"walk\"\nclips = [{ name = \"walk\" }]\n[[phases]]\nsamples = 24\ntask = 0.0\n";
    let idle = "skill = \"idle\"\nparent = \"walk\"\nclips = [{ name = \"idle\" }]\n[[phases]]\nsamples = 24\ntask = 0.5\n";
    for skill in [walk, idle] {
        let mut run = workplace.prepare(recipe(skill), 1, Existing::Overwrite).unwrap();
        run.advance().unwrap();
        run.save().unwrap();
    }
    let both = "skill = \"both\"\npaths = [[\"walk\", \"idle\"]]\n[[phases]]\nsamples = 100000\ntask = 0.5\n";
    let mut all = recipe(both);
    all.environment.start.along = true;
    assert_eq!(best_imitation(&mut workplace.prepare(all.clone(), 1, Existing::Overwrite).unwrap()), 0.0);
    // Those that are no imitators, here nearly surely all, are neither paid for it nor fail by it.
    all.skill = "others".into();
    (all.environment.imitators, all.environment.imitation) = (1e-9, 0.5);
    assert_eq!(best_imitation(&mut workplace.prepare(all.clone(), 1, Existing::Overwrite).unwrap()), 0.0);
    all.skill = "again".into();
    (all.environment.imitators, all.environment.imitation) = (1.0, 0.5);
    let best = best_imitation(&mut workplace.prepare(all.clone(), 1, Existing::Overwrite).unwrap());
    assert!((0.3..1.0).contains(&best), "{best}");

    // Where nothing is near enough, who has lost the clip in the first tick is not found again in the next.
    let strict = Workplace { recipes: folder.path().join("strict"), ..workplace.clone() };
    std::fs::create_dir(&strict.recipes).unwrap();
    for skill in ["walk", "idle"] {
        let mut recipe = workplace.recipe(skill).unwrap();
        recipe.environment.lost_metres = 1e-6;
        let path = strict.recipes.join(format!("{skill}.toml"));
        std::fs::write(path, toml::to_string(&recipe).unwrap()).unwrap();
    }
    all.skill = "strict".into();
    let mut run = strict.prepare(all, 1, Existing::Overwrite).unwrap();
    run.advance().unwrap();
    let mut mean = || {
        let reports = (0..6).map(|_| run.advance().unwrap().population);
        let (imitation, ticks) =
            reports.fold((0.0, 0.0), |sum, p| (sum.0 + p.imitation, sum.1 + p.ticks as f64));
        imitation / ticks
    };
    let after_the_first_ticks = mean();
    assert!(after_the_first_ticks < 0.1 * best, "{after_the_first_ticks} against {best}");
}

fn the_pack_acts_as_the_trainer(pack: &CharacterPack, ingredients: &[Ingredient]) {
    let input: Vec<f32> = (0..POLICY_INPUT_LEN).map(|i| (i as f32 * 0.7).sin()).collect();
    for (node, policy) in pack.graph().nodes().iter().zip(pack.policies()) {
        let network = &ingredients.iter().find(|i| i.skill == node.name).unwrap().actor;
        let mut pass = Pass::new(network.sizes(), 1);
        pass.forward(network, None, &input);
        let mut action = [0.0; DOF_COUNT];
        policy.evaluate_into(Arithmetic::Reproducible, &input, &mut MlpScratch::for_mlp(policy), &mut action);
        let worst = action.iter().zip(pass.output(1)).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(worst < 1e-5, "{}: {worst}", node.name);
    }
}

#[test]
fn a_phase_has_its_own_settings_until_it_ends() {
    let text = "skill = \"a\"\nclips = [{ name = \"walk\" }]\n[[phases]]\nsamples = 10\ntask = 0.5\nquiet = 0.25\nother = 0.5\n\
        [[phases]]\nsamples = 10\ntask = 0.5\n[environment]\nquiet = 0.125\n";
    let recipe = Recipe::parse(Path::new("x.toml"), text).unwrap();
    let at =
        |samples: u64| (recipe.environment_at(samples).quiet, recipe.environment_at(samples).start.other);
    assert_eq!([at(0), at(9), at(10), at(99)], [(0.25, 0.5), (0.25, 0.5), (0.125, 0.0), (0.125, 0.0)]);
}

#[test]
fn unknown_fields_and_senseless_values_are_named() {
    let parse = |text: &str| Recipe::parse(Path::new("x.toml"), text).unwrap_err().to_string();
    let good = "skill = \"a\"\nclips = [{ name = \"walk\" }]\n[[phases]]\nsamples = 1\ntask = 0.5\n";
    assert!(Recipe::parse(Path::new("x.toml"), good).is_ok());
    assert!(parse(&format!("{good}[ppo]\ngama = 0.9\n")).contains("gama"));
    assert!(parse(&format!("{good}[ppo]\ngamma = 1.0\n")).contains("ppo.gamma"));
    assert!(parse(&good.replace("0.5", "1.5")).contains("phases.task"));
    assert!(parse(&good.replace("0.5", "0.5\nimitation = 0.6")).contains("imitation"));
    assert!(parse(&good.replace("0.5", "0.5\nguide = -1.0")).contains("phases.guide"));
    let together = good.replace("clips = [{ name = \"walk\" }]", "paths = [[\"a\", \"b\"]]");
    assert!(Recipe::parse(Path::new("x.toml"), &together).is_ok());
    assert!(parse(&together.replace("0.5", "0.5\nguide = 0.1")).contains("paths"));
    assert!(parse(&together.replace("0.5", "0.5\nimitation = 0.1")).contains("paths"));
    assert!(parse(&format!("{good}[environment]\nimitators = 0.1\n")).contains("imitators"));
    let after = "[environment.start]\nafter = { skill = \"get_up\", share = 0.1 }\n";
    assert!(Recipe::parse(Path::new("x.toml"), &format!("{together}{after}")).is_ok());
    assert!(parse(&format!("{good}{after}")).contains("start.after"));
    assert!(parse(&format!("{together}{}", after.replace("0.1", "1.5"))).contains("start.after"));
    assert!(parse(&good.replace("0.5", "0.5\nfall_cost = -1.0")).contains("fall_cost"));
    assert!(parse(&good.replace("0.5", "0.5\nmishap = 1.5")).contains("mishap"));
    assert!(parse(&good.replace("0.5", "0.5\nquiet = 1.0")).contains("quiet"));
    assert!(parse(&good.replace("0.5", "0.5\nmishap = 0.5\nimitation = 0.5")).contains("mishap"));
    assert!(parse(&format!("{good}[environment]\nleast_width_mps = 0.0\n")).contains("least_width_mps"));
    assert!(parse(&good.replace("\"a\"", "\"../a\"")).contains("skill"));
    assert!(parse(&good.replace("skill = \"a\"", "skill = \"a\"\nedge = true")).contains("edge"));
    assert!(parse("").contains("skill"));
}
