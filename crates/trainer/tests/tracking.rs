//! Characters that are rewarded for tracking their clip: how well they do, and when they have lost it.

mod common;

use std::path::Path;

use common::{small, workspace_with_clips};
use trainer::recipe::Recipe;
use trainer::run::{Existing, Run};
use trainer::workspace::Workspace;

#[test]
fn a_character_that_starts_in_its_clip_tracks_it_until_its_error_is_too_large() {
    let folder = tempfile::tempdir().unwrap();
    let workspace = workspace_with_clips(folder.path());
    let text = "skill = \"walk\"\nclips = [{ name = \"walk\" }]\n[[phases]]\nsamples = 100000\n\
        environment.reward = { task_weight = 0.0, tracking_weight = 1.0 }\n";
    let recipe = small(Recipe::parse(Path::new("x.toml"), text).unwrap());
    let best = best_tracking(&mut workspace.prepare(recipe, Some(1), Existing::Overwrite).unwrap());
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
        let mut run = workspace.prepare(recipe(skill), Some(1), Existing::Overwrite).unwrap();
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
    assert_eq!(
        best_tracking(&mut workspace.prepare(all.clone(), Some(1), Existing::Overwrite).unwrap()),
        0.0
    );
    // Those that are no trackers, here nearly surely all, are neither paid for it nor fail by it.
    all.skill = "others".into();
    set(&mut all, 1e-9);
    assert_eq!(
        best_tracking(&mut workspace.prepare(all.clone(), Some(1), Existing::Overwrite).unwrap()),
        0.0
    );
    all.skill = "again".into();
    set(&mut all, 1.0);
    let best = best_tracking(&mut workspace.prepare(all.clone(), Some(1), Existing::Overwrite).unwrap());
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
    let mut run = strict.prepare(all, Some(1), Existing::Overwrite).unwrap();
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
