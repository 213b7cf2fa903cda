//! `trainer search`: weights of an average of policies, and its posture, that reach what a file asks for.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Duration;

use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use clips::ClipFolder;
use evaluation::{Chosen, Effort, Named, Progress, Section, evaluate};
use files::{read_text_bounded, write_atomically};
use indicatif::{ProgressBar, ProgressStyle};
use physics::Engine;
use physics_bridge::Model;
use policy_core::{CharacterPack, CharacterState, ControllerConfig};
use serde_json::Value;
use trainer::average::average;
use trainer::checkpoint::CheckpointError;
use trainer::pack::{TrainedSkill, with_policy};
use trainer::posture::Posture;
use trainer::search::{Candidate, Search, Searcher, Trial};
use trainer::workspace::CheckpointFile;

use super::evaluate::states_of_clips;
use super::interrupt::Interrupt;
use super::output::say;

/// File of all trials in the folder of a search, one JSON object a line.
const TRIALS: &str = "trials.jsonl";

/// File of the best pack there.
const BEST: &str = "best.pack.safetensors";

/// Largest file of trials, bytes.
const MOST_BYTES: u64 = 64 << 20;

/// Arguments of the verb.
#[derive(Args)]
pub(crate) struct Arguments {
    /// What is searched, and for what (TOML).
    file: PathBuf,
    /// Pack in which the policy is measured.
    #[arg(long, default_value = "assets/humanoid.pack.safetensors")]
    pack: PathBuf,
    /// Folder for trials.jsonl, which has every trial, and best.pack.safetensors. With trials of this search in it, it is continued.
    #[arg(long)]
    out: PathBuf,
    /// Trials in all, those of earlier runs included.
    #[arg(long, default_value_t = 500, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    trials: u32,
    /// Seed of what is drawn.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// What candidates are measured in.
struct Bench {
    search: Search,
    engine: physics::Model,
    pack: CharacterPack,
    checkpoints: Vec<CheckpointFile>,
    /// States of the clips that motions are compared with.
    states: BTreeMap<String, Vec<CharacterState>>,
    effort: Effort,
}

/// Searches until all trials are made, or a signal comes.
pub(crate) fn run(
    model: &Model,
    recipes: &Path,
    clips: Option<&ClipFolder>,
    newest: &dyn Fn(&str) -> Result<Option<CheckpointFile>, CheckpointError>,
    a: &Arguments,
) -> Result<ExitCode> {
    let search = Search::load(&a.file)?;
    let needs_clips = search.sections().contains(&Section::Motion);
    ensure!(
        !needs_clips || clips.is_some(),
        "the section motion needs clips: name their folder by --motions"
    );
    let load = |name: &String| {
        let expected = || format!("expected a run or a kept checkpoint named {name}, found none");
        newest(name)?.with_context(expected)
    };
    let pack = super::load::pack(&a.pack)?;
    let bench = Bench {
        checkpoints: search.of.iter().map(load).collect::<Result<_>>()?,
        engine: physics::Model::new(model, Engine::Mujoco)?,
        states: match clips.filter(|_| needs_clips) {
            Some(clips) => states_of_clips(model, recipes, clips, &pack)?,
            None => BTreeMap::new(),
        },
        effort: effort(&search),
        search: search.clone(),
        pack,
    };
    let mut searcher = Searcher::new(search, a.seed);
    std::fs::create_dir_all(&a.out).with_context(|| format!("cannot make {}", a.out.display()))?;
    let path = a.out.join(TRIALS);
    replay(&mut searcher, &path)?;
    let cannot = || format!("cannot write {}", path.display());
    let mut trials = OpenOptions::new().append(true).create(true).open(&path).with_context(cannot)?;
    let interrupt = Interrupt::listen()?;
    let bar = bar(a.trials.into(), searcher.tries() as u64);
    while searcher.tries() < a.trials as usize {
        if let Some(signal) = interrupt.caught() {
            bar.finish_and_clear();
            say(format_args!("stopped by {} after {} trials", signal.name(), searcher.tries()))?;
            return Ok(signal.exit_code());
        }
        let least = searcher.best().map(|best| best.cost);
        let trial = searcher.go_on(|candidate, section| bench.measure(candidate, section))?;
        append(&mut trials, &trial).with_context(cannot)?;
        bar.inc(1);
        if least.is_none_or(|least| trial.cost < least) {
            let best = a.out.join(BEST);
            let bytes = bench.pack_with(&trial.candidate)?.to_bytes();
            write_atomically(&best, &bytes).with_context(|| format!("cannot write {}", best.display()))?;
            bar.suspend(|| say(format_args!("{}: {}", searcher.tries(), told(&bench.search, &trial))))?;
        }
    }
    bar.finish_and_clear();
    let best = searcher.best().map(|best| told(&bench.search, best)).unwrap_or_default();
    say(format_args!("the best of {}: {best}", searcher.tries()))?;
    Ok(ExitCode::SUCCESS)
}

/// A progress bar with rate and time left.
fn bar(trials: u64, made: u64) -> ProgressBar {
    let style = "{elapsed:>4} {wide_bar} {human_pos}/{human_len} trials {per_sec} {eta} left";
    let style = ProgressStyle::with_template(style).unwrap_or_else(|_| ProgressStyle::default_bar());
    let bar = ProgressBar::new(trials).with_style(style).with_position(made);
    bar.enable_steady_tick(Duration::from_millis(500));
    bar.reset_eta();
    bar
}

/// How much is measured.
fn effort(search: &Search) -> Effort {
    let effort = search.characters.map_or(Effort::FULL, |count| Effort::FULL.with_characters(count.into()));
    effort.only(&chosen(&search.gaits), &chosen(&search.grounds), &chosen(&search.cases))
}

/// Those of a list that have these names.
fn chosen<L: Named>(names: &[String]) -> Vec<Chosen<L>> {
    names.iter().filter_map(|name| Chosen::from_name(name)).collect()
}

/// Takes the trials that an earlier run has left.
fn replay(searcher: &mut Searcher, path: &Path) -> Result<()> {
    if !path.exists() {
        return Ok(());
    }
    let text =
        read_text_bounded(path, MOST_BYTES).with_context(|| format!("cannot read {}", path.display()))?;
    for (index, line) in text.lines().enumerate() {
        let at = || format!("{}, line {}", path.display(), index + 1);
        let trial: Trial = serde_json::from_str(line).with_context(at)?;
        if let Err([expected, found]) = searcher.replay(&trial) {
            bail!("{}: expected {expected} next, found {found}: is it of another file or seed?", at());
        }
    }
    Ok(())
}

fn append(file: &mut File, trial: &Trial) -> Result<()> {
    let mut line = serde_json::to_string(trial)?;
    line.push('\n');
    file.write_all(line.as_bytes())?;
    Ok(file.flush()?)
}

/// A trial in words.
fn told(search: &Search, trial: &Trial) -> String {
    let number = |number: &Option<f64>| number.map_or("none".to_owned(), |number| format!("{number:.4}"));
    let measured = search.aims.iter().zip(&trial.measured);
    let measured: Vec<String> =
        measured.map(|(aim, found)| format!("{} {}", aim.measure, number(found))).collect();
    format!("cost {:.3}, {}; {}", trial.cost, trial.candidate, measured.join(", "))
}

impl Bench {
    fn pack_with(&self, candidate: &Candidate) -> Result<CharacterPack> {
        let search = &self.search;
        let posture = Posture::of(self.pack.skeleton(), &candidate.posture)?;
        let mean = average(&self.checkpoints, search.averaging(&candidate.weights, posture.as_ref()))?;
        let skill = search.policy.as_deref().unwrap_or(&search.replaces);
        let trained = TrainedSkill::from_checkpoint(skill, &mean, &self.checkpoints[0].1)?;
        Ok(with_policy(&self.pack, &TrainedSkill { skill: search.replaces.clone(), ..trained })?)
    }

    /// The report of a section with a candidate.
    fn measure(&self, candidate: &Candidate, section: Section) -> Result<Value> {
        let pack = Arc::new(self.pack_with(candidate)?);
        let config = ControllerConfig::default();
        let what = (&self.effort, &[section][..]);
        let evaluation =
            evaluate(&self.engine, &pack, config, what, &self.states, &Progress::hidden(), |_| ())?;
        Ok(serde_json::to_value(&evaluation)?)
    }
}
