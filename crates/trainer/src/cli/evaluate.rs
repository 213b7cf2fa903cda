//! `trainer evaluate`: evaluates a pack.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Context, Result};
use clap::Args;
use clips::ClipFolder;
use evaluation::stress::{CaseList, Cases, GroundList, Grounds};
use evaluation::trial::{GaitList, Gaits};
use evaluation::{
    Chosen, Effort, Evaluation, Named, PlayerReport, Progress, Section, clip_states, evaluate, plots, table,
};
use files::write_atomically;
use physics::Engine;
use physics_bridge::Model;
use policy_core::{CharacterPack, CharacterState, ControllerConfig, GiveWay, Steering, TurnAssist};
use trainer::recipe::Recipe;

use super::output::say;

/// Arguments of the verb.
#[derive(Args)]
pub(crate) struct Arguments {
    /// The pack.
    #[arg(required_unless_present = "from")]
    pack: Option<PathBuf>,
    /// Print and draw what an earlier run has written to this file, and measure nothing.
    #[arg(long, conflicts_with_all = ["pack", "json", "quick", "only", "gaits", "grounds", "cases", "physics", "characters"])]
    from: Option<PathBuf>,
    /// File to write the measures to.
    #[arg(long)]
    json: Option<PathBuf>,
    /// File to draw a page of plots of what a player feels to, as SVG.
    #[arg(long)]
    plots: Option<PathBuf>,
    /// Fewer characters and seconds: under three minutes.
    #[arg(long)]
    quick: bool,
    /// Evaluate only these sections, comma-separated; an unknown name lists them.
    #[arg(long, value_delimiter = ',', value_parser = section)]
    only: Vec<Section>,
    /// Measure what is measured by gait in these gaits alone, comma-separated; an unknown name lists them. Figures are the same as with
    /// all of them.
    #[arg(long, value_delimiter = ',', value_parser = chosen::<GaitList>)]
    gaits: Vec<Gaits>,
    /// Measure terrain and get_up on these grounds alone, comma-separated; an unknown name lists them. Figures are the same as with all of
    /// them.
    #[arg(long, value_delimiter = ',', value_parser = chosen::<GroundList>)]
    grounds: Vec<Grounds>,
    /// Measure robustness in these cases alone, comma-separated, such as strength_x0.8; an unknown name lists them. Figures are the same as
    /// with all of them.
    #[arg(long, value_delimiter = ',', value_parser = chosen::<CaseList>)]
    cases: Vec<Cases>,
    /// Physics engine: mujoco or rapier. Rapier skips the sections encounters and race.
    #[arg(long, default_value = "mujoco", value_parser = engine)]
    physics: Engine,
    /// Number of characters in every measurement. Published figures use the defaults.
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=10_000))]
    characters: Option<u16>,
    /// Leave turning to the policies: the player's controller does not slow down to turn.
    #[arg(long)]
    no_turn_assist: bool,
    /// Give the policies the target as it is: the player's controller neither trims against drift nor leads into turns.
    #[arg(long)]
    no_steering: bool,
    /// Walk on against what holds the character up: the player's controller does not stop for a moment.
    #[arg(long)]
    no_give_way: bool,
    /// Leave variants for rough ground out: gaits act alone on every ground.
    #[arg(long)]
    no_footing: bool,
    /// Leave agile variants out: gaits turn, start and stop by themselves.
    #[arg(long)]
    no_agility: bool,
    /// Leave capture steps and catches out: a character that is pushed goes on in its gait.
    #[arg(long)]
    no_capture_steps: bool,
    /// Seconds in which the player's controller passes from the joint targets before a skill to those of the skill.
    #[arg(long, default_value_t = 0.0, value_parser = seconds)]
    handover_secs: f32,
    /// Seconds after a skill in which the player's controller stays in the gait that the skill returns to.
    #[arg(long, default_value_t = ControllerConfig::default().settle_secs, value_parser = seconds)]
    settle_secs: f32,
}

/// A time that a controller takes.
fn seconds(text: &str) -> Result<f32, String> {
    let secs = text.parse::<f32>().ok().filter(|secs| (0.0..=10.0).contains(secs));
    secs.ok_or_else(|| "expected seconds from 0 to 10".into())
}

/// The section of a name.
fn section(name: &str) -> Result<Section, String> {
    let names = || Section::ALL.map(Section::name).join(", ");
    Section::from_name(name).ok_or_else(|| format!("expected one of {}", names()))
}

/// The one of a list that has a name.
fn chosen<L: Named>(name: &str) -> Result<Chosen<L>, String> {
    Chosen::from_name(name).ok_or_else(|| format!("expected one of {}", Chosen::<L>::names().join(", ")))
}

/// The engine of a name.
fn engine(name: &str) -> Result<Engine, String> {
    let names = || Engine::ALL.map(Engine::name).join(" or ");
    Engine::from_name(name).ok_or_else(|| format!("expected {}", names()))
}

/// Measures.
pub(crate) fn run(
    model: &Model,
    recipes: &Path,
    clips: Option<&ClipFolder>,
    arguments: &Arguments,
) -> Result<()> {
    if let Some(path) = &arguments.from {
        let text = std::fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
        let player = serde_json::from_slice(&text).with_context(|| path.display().to_string())?;
        return show(&player, arguments.plots.as_deref());
    }
    for file in [&arguments.json, &arguments.plots].into_iter().flatten() {
        make_ready(file).with_context(|| format!("cannot write {}", file.display()))?;
    }
    let path = arguments.pack.as_ref().context("expected a pack")?;
    let pack = super::load::pack(path)?;
    let effort = if arguments.quick { Effort::QUICK } else { Effort::FULL };
    let effort = arguments.characters.map_or(effort, |count| effort.with_characters(count.into()));
    let effort = effort.only(&arguments.gaits, &arguments.grounds, &arguments.cases);
    let sections: &[Section] = if arguments.only.is_empty() { &Section::ALL } else { &arguments.only };
    let states = match clips.filter(|_| sections.contains(&Section::Motion)) {
        Some(clips) => states_of_clips(model, recipes, clips, &pack)?,
        None => BTreeMap::new(),
    };
    let turn_assist = (!arguments.no_turn_assist).then(TurnAssist::default);
    let handover_secs = arguments.handover_secs;
    let steering = (!arguments.no_steering).then(Steering::default);
    let give_way = (!arguments.no_give_way).then(GiveWay::default);
    let (footing, agility) = (!arguments.no_footing, !arguments.no_agility);
    let config = ControllerConfig {
        steering,
        turn_assist,
        handover_secs,
        settle_secs: arguments.settle_secs,
        give_way,
        footing,
        agility,
        capture_steps: !arguments.no_capture_steps,
        ..ControllerConfig::default()
    };
    let progress = Progress::bar();
    let model = physics::Model::new(model, arguments.physics)?;
    // The file has what was measured so far, also where a later section fails.
    let mut written = Ok(());
    let write = |evaluation: &Evaluation| {
        if let Some(path) = &arguments.json {
            written = write_json(evaluation, path);
        }
    };
    let (pack, what) = (Arc::new(pack), (&effort, sections));
    let evaluation = evaluate(&model, &pack, config, what, &states, &progress, write)?;
    progress.finish();
    match written {
        Ok(()) if arguments.json.is_some() => {}
        written => {
            say(serde_json::to_string_pretty(&evaluation)?)?;
            written?;
        }
    }
    show(&evaluation.player, arguments.plots.as_deref())
}

/// Makes the folder of a file that is to be written after hours, and tries whether it can be.
fn make_ready(file: &Path) -> std::io::Result<()> {
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder)?;
    if file.is_dir() {
        return Err(std::io::ErrorKind::IsADirectory.into());
    }
    let trial = folder.join(format!(".trainer-evaluate-{}", std::process::id()));
    std::fs::write(&trial, b"")?;
    std::fs::remove_file(&trial)
}

fn write_json(evaluation: &Evaluation, path: &Path) -> Result<()> {
    let text = serde_json::to_string_pretty(evaluation)?;
    write_atomically(path, text.as_bytes()).with_context(|| format!("cannot write {}", path.display()))
}

/// Prints the tables and draws the plots.
fn show(player: &PlayerReport, svg: Option<&Path>) -> Result<()> {
    if let Some(svg) = svg {
        let drawn = plots::draw(player).with_context(|| format!("cannot draw {}", svg.display()))?;
        write_atomically(svg, drawn.as_bytes()).with_context(|| format!("cannot write {}", svg.display()))?;
    }
    std::io::stderr().lock().write_all(table(player).as_bytes()).context("cannot write to the standard error")
}

/// States of the first clip of every skill that has a recipe.
pub(super) fn states_of_clips(
    model: &Model,
    recipes: &Path,
    clips: &ClipFolder,
    pack: &CharacterPack,
) -> Result<BTreeMap<String, Vec<CharacterState>>> {
    let mut states = BTreeMap::new();
    for (_, node) in pack.graph().originals() {
        let path = recipes.join(format!("{}.toml", node.name));
        if !path.is_file() {
            continue;
        }
        if let Some(clip) = Recipe::load(&path)?.clips.first() {
            states.insert(node.name.clone(), clip_states(model, &clip.load(clips)?)?);
        }
    }
    Ok(states)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_tried_before_anything_is_measured() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("deep/er/evaluation.json");
        make_ready(&file).unwrap();
        assert_eq!(std::fs::read_dir(file.parent().unwrap()).unwrap().count(), 0, "the trial is removed");
        make_ready(&file).unwrap();
        assert!(make_ready(folder.path()).is_err(), "a folder is no file");
        std::fs::write(&file, b"an earlier one").unwrap();
        assert!(make_ready(&file.join("x.json")).is_err(), "a file is no folder");
        make_ready(&file).unwrap();
        assert_eq!(std::fs::read(&file).unwrap(), b"an earlier one");
    }
}
