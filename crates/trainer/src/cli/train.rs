//! `trainer train`: one skill, or the whole graph in order.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

use anyhow::{Result, ensure};
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use trainer::env::{DT_SECS, NodeReport, REPORTED_NODES, TrainingGraph};
use trainer::lineage::Lineage;
use trainer::recipe::Recipe;
use trainer::run::{Existing, Run, RunError, RunFolder, holds_a_run};
use trainer::workspace::Workspace;

use super::interrupt::{Interrupt, Signal};
use super::output::{complain, say};

/// Arguments of the verb.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Skill whose recipe to run, or the file of a recipe.
    #[arg(required_unless_present_any = ["all", "plan"], conflicts_with_all = ["all", "plan"])]
    skill: Option<String>,
    /// Run all recipes, parents before children.
    #[arg(long, conflicts_with = "plan")]
    all: bool,
    /// Run a lineage: runs in order, with what each starts from, and averages.
    #[arg(long, value_name = "FILE")]
    plan: Option<PathBuf>,
    /// Continue existing runs from their last checkpoint; finished runs are left alone.
    #[arg(long, conflicts_with = "overwrite")]
    resume: bool,
    /// Delete existing runs and start anew.
    #[arg(long)]
    overwrite: bool,
    /// Start from the networks of this run, or of its kept checkpoint, instead of the parent's. Of a run that trained several
    /// skills together, those of this skill.
    #[arg(long, value_name = "RUN", requires = "skill")]
    from: Option<String>,
    /// Samples that count as taken by a run that starts from another, so that it begins in a later phase of its recipe.
    #[arg(long, value_name = "SAMPLES", requires = "from", default_value_t = 0)]
    from_samples: u64,
    /// Seed of the random numbers, 1 by default; a run that continues keeps its own, and a lineage has its own.
    #[arg(long, conflicts_with = "plan")]
    seed: Option<u64>,
    /// Threads, 1 to 1024; the processor's number by default.
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Stop after this many iterations.
    #[arg(long)]
    iterations: Option<u64>,
}

/// Trains.
pub(crate) fn run(workspace: &Workspace, arguments: &Arguments) -> Result<ExitCode> {
    let interrupt = Interrupt::listen()?;
    if let Some(threads) = arguments.threads {
        rayon::ThreadPoolBuilder::new().num_threads(threads.into()).build_global()?;
    }
    let existing = match (arguments.resume, arguments.overwrite) {
        (true, _) => Existing::Resume,
        (_, true) => Existing::Overwrite,
        _ => Existing::Refuse,
    };
    let mut stopped = None;
    let mut step = |run: &mut Run| -> Result<bool> {
        run.notes.iter().for_each(complain);
        train(run, arguments.iterations, &interrupt)?;
        stopped = interrupt.caught().map(|signal| {
            complain(&how_to_continue(run, signal, std::env::args()));
            signal.exit_code()
        });
        Ok(stopped.is_none())
    };
    if let Some(plan) = &arguments.plan {
        Lineage::load(plan)?.execute(workspace, existing, &mut step)?;
        return Ok(stopped.unwrap_or(ExitCode::SUCCESS));
    }
    let recipes = match &arguments.skill {
        Some(file) if file.ends_with(".toml") => vec![Recipe::load(Path::new(file))?],
        Some(skill) => vec![workspace.recipe(skill)?],
        None => workspace.recipes_in_order()?,
    };
    ensure!(!recipes.is_empty(), "expected recipes in {}, found none", workspace.recipes.display());
    // Refused before hours are spent on the runs before it.
    for folder in recipes.iter().map(|recipe| workspace.runs.join(&recipe.skill)) {
        if existing == Existing::Refuse && holds_a_run(&folder) {
            return Err(RunError::Exists { folder }.into());
        }
    }
    if existing == Existing::Overwrite && arguments.skill.is_none() {
        // All at once: one that is interrupted and resumed must take neither what an earlier training left for its own, nor what is
        // kept.
        let folders = || recipes.iter().map(|recipe| workspace.runs.join(&recipe.skill));
        RunFolder::clear_all(folders())?;
        for folder in folders() {
            RunFolder::open(folder, existing)?.begin_anew()?;
        }
    }
    for recipe in recipes {
        let mut run = match &arguments.from {
            Some(from) => {
                workspace.prepare_from(from, arguments.from_samples, recipe, arguments.seed, existing)?
            }
            None => workspace.prepare(recipe, arguments.seed, existing)?,
        };
        if !step(&mut run)? {
            break;
        }
    }
    Ok(stopped.unwrap_or(ExitCode::SUCCESS))
}

/// What a user who stopped a run should know.
fn how_to_continue(run: &Run, signal: Signal, arguments: impl Iterator<Item = String>) -> String {
    format!(
        "stopped by {} after {} samples, saved in {}; continue with `{}`",
        signal.name(),
        run.training.samples,
        run.folder.path().display(),
        command_to_continue(arguments)
    )
}

/// The command of these arguments, the program's name first, that continues what it began.
fn command_to_continue(arguments: impl Iterator<Item = String>) -> String {
    let again = |argument: &String| argument != "--overwrite" && argument != "--resume";
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./=,:+@%".contains(c);
    let shown = |argument: String| match !argument.is_empty() && argument.chars().all(is_plain) {
        true => argument,
        false => format!("'{}'", argument.replace('\'', "'\\''")),
    };
    let words = arguments.skip(1).filter(again).map(shown);
    ["trainer".to_owned()]
        .into_iter()
        .chain(words)
        .chain(["--resume".to_owned()])
        .collect::<Vec<_>>()
        .join(" ")
}

fn add(sums: &mut [NodeReport; REPORTED_NODES], more: &[NodeReport; REPORTED_NODES]) {
    for (sum, more) in sums.iter_mut().zip(more) {
        sum.ticks += more.ticks;
        sum.failed += more.failed;
        sum.speed_mps += more.speed_mps;
    }
}

/// Falls per character-minute and speed nearest to every node.
fn by_node(graph: &TrainingGraph, nodes: &[NodeReport]) -> String {
    let told = graph.nodes().iter().zip(nodes).map(|(node, report)| {
        let ticks = report.ticks.max(1) as f64;
        let falls = f64::from(report.failed) / (ticks * f64::from(DT_SECS) / 60.0);
        format!("{} {falls:.1}/min {:.2} m/s", node.name, report.speed_mps / ticks)
    });
    told.collect::<Vec<_>>().join(", ")
}

fn train(run: &mut Run, iterations: Option<u64>, interrupt: &Interrupt) -> Result<()> {
    let skill = run.training.recipe.skill.clone();
    let bar = ProgressBar::new(run.training.recipe.total_samples());
    let style = "{prefix:>8} {wide_bar} {human_pos}/{human_len} {per_sec} {eta} {msg}";
    bar.set_style(ProgressStyle::with_template(style)?);
    bar.set_prefix(skill.clone());
    bar.enable_steady_tick(Duration::from_secs(1));
    bar.set_position(run.training.samples);
    bar.reset_eta();
    let mut done = 0;
    let mut nodes = [NodeReport::default(); REPORTED_NODES];
    while !run.is_done() && iterations.is_none_or(|most| done < most) && interrupt.caught().is_none() {
        let report = run.advance()?;
        done += 1;
        let p = &report.episodes;
        bar.set_position(run.training.samples);
        let tracking = p.tracking / p.ticks.max(1) as f64;
        bar.set_message(format!(
            "style {:.2} task {:.2} tracking {tracking:.2} episode {:.0} kl {:.3} distance {:.2} secs {:.2}+{:.2}+{:.2}",
            report.style,
            p.task / p.ticks.max(1) as f64,
            p.episode_ticks as f64 / f64::from(p.episodes.max(1)),
            report.update.kl,
            report.distance,
            report.secs[0],
            report.secs[1],
            report.secs[2],
        ));
        add(&mut nodes, &p.nodes);
        if bar.is_hidden() && done % 20 == 0 {
            say(format_args!("{skill} {} {}", run.training.samples, bar.message()))?;
            if run.training.graph().nodes().len() > 2 {
                say(by_node(run.training.graph(), &nodes))?;
            }
            nodes = Default::default();
        }
    }
    if done > 0 {
        run.save()?;
    }
    bar.finish();
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stopped_training_continues_by_its_own_arguments() {
        let words = |line: &'static str| line.split('|').map(str::to_owned);
        let again = |line| command_to_continue(words(line));
        assert_eq!(
            again("/bin/trainer|--runs|my runs|train|walk|--seed|7|--overwrite|--model|it's.xml"),
            r"trainer --runs 'my runs' train walk --seed 7 --model 'it'\''s.xml' --resume"
        );
        assert_eq!(again("trainer|train|--all|--resume"), "trainer train --all --resume");
    }
}
