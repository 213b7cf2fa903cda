//! `trainer train`: one skill, or the whole graph in order.

use std::path::Path;
use std::time::Duration;

use anyhow::Result;
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use trainer::env::{Course, DT_SECS, NodeReport, REPORTED_NODES};
use trainer::recipe::Recipe;
use trainer::run::Run;
use trainer::workplace::Workplace;

/// Arguments of the verb.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Skill whose recipe to run, or the file of a recipe.
    #[arg(required_unless_present = "all", conflicts_with = "all")]
    skill: Option<String>,
    /// Run all recipes, parents before children.
    #[arg(long)]
    all: bool,
    /// Go on from the last checkpoint; finished runs are left alone.
    #[arg(long)]
    resume: bool,
    /// Seed of the random numbers.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Threads; one makes a run repeat itself whatever else the machine does.
    #[arg(long)]
    threads: Option<usize>,
    /// Stop after this many iterations.
    #[arg(long)]
    iterations: Option<u64>,
}

/// Trains.
pub(crate) fn run(workplace: &Workplace, arguments: &Arguments) -> Result<()> {
    if let Some(threads) = arguments.threads {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;
    }
    let recipes = match &arguments.skill {
        Some(file) if file.ends_with(".toml") => vec![Recipe::load(Path::new(file))?],
        Some(skill) => vec![workplace.recipe(skill)?],
        None => workplace.recipes_in_order()?,
    };
    for recipe in recipes {
        let mut run = workplace.prepare(recipe, arguments.seed, arguments.resume)?;
        train(&mut run, arguments.iterations)?;
    }
    Ok(())
}

fn add(sums: &mut [NodeReport; REPORTED_NODES], more: &[NodeReport; REPORTED_NODES]) {
    for (sum, more) in sums.iter_mut().zip(more) {
        sum.ticks += more.ticks;
        sum.failed += more.failed;
        sum.speed_mps += more.speed_mps;
    }
}

/// Falls per character-minute and speed nearest to every node.
fn by_node(course: &Course, nodes: &[NodeReport]) -> String {
    let told = course.nodes().iter().zip(nodes).map(|(node, report)| {
        let ticks = report.ticks.max(1) as f64;
        let falls = f64::from(report.failed) / (ticks * f64::from(DT_SECS) / 60.0);
        format!("{} {falls:.1}/min {:.2} m/s", node.name, report.speed_mps / ticks)
    });
    told.collect::<Vec<_>>().join(", ")
}

fn train(run: &mut Run, iterations: Option<u64>) -> Result<()> {
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
    while !run.is_done() && iterations.is_none_or(|most| done < most) {
        let report = run.advance()?;
        done += 1;
        let p = &report.population;
        bar.set_position(run.training.samples);
        let imitated = p.imitation / p.ticks.max(1) as f64;
        bar.set_message(format!(
            "style {:.2} task {:.2} imitation {imitated:.2} episode {:.0} kl {:.3} distance {:.2} secs {:.2}+{:.2}+{:.2}",
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
            println!("{skill} {} {}", run.training.samples, bar.message());
            if run.training.course().nodes().len() > 2 {
                println!("{}", by_node(run.training.course(), &nodes));
            }
            nodes = Default::default();
        }
    }
    run.save()?;
    bar.finish();
    Ok(())
}
