//! `trainer average`: one checkpoint out of several of the same sizes.

use std::path::PathBuf;

use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use trainer::average::{Averaging, average};
use trainer::checkpoint::Checkpoint;

use super::output::say;

/// Arguments of the verb.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Checkpoints, at least two; everything but the policies is the first one's.
    #[arg(required = true)]
    checkpoints: Vec<PathBuf>,
    /// File to write, as RUNS/SKILL/checkpoint.safetensors.
    #[arg(long)]
    out: PathBuf,
    /// Weight of each checkpoint, adding up to 1; equal ones by default. One below zero leads away from that checkpoint.
    #[arg(long, value_delimiter = ',', allow_hyphen_values = true)]
    weights: Vec<f64>,
    /// Skills, of those trained together, whose policies stay as they are in the first checkpoint.
    #[arg(long, value_delimiter = ',')]
    except: Vec<String>,
    /// Skill whose policy checkpoints give that trained several skills together, where the first one trained a skill alone.
    #[arg(long)]
    policy: Option<String>,
}

/// Averages.
pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let Arguments { weights, except, policy, .. } = arguments;
    let averaging = Averaging { weights, except, policy: policy.as_deref() };
    if let Err([expected, found]) = averaging.check(arguments.checkpoints.len()) {
        bail!("expected {expected}, found {found}");
    }
    let load = |path: &PathBuf| Checkpoint::load(path).map(|checkpoint| (checkpoint, path.clone()));
    let checkpoints = arguments.checkpoints.iter().map(load).collect::<Result<Vec<_>, _>>()?;
    for skill in &arguments.except {
        let known = checkpoints[0].0.networks.contains_key(&format!("{skill}.actor"));
        ensure!(known, "{}: expected a policy of {skill}, found none", arguments.checkpoints[0].display());
    }
    if let Some(folder) = arguments.out.parent() {
        std::fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    }
    average(&checkpoints, averaging)?.save(&arguments.out)?;
    say(format_args!("wrote {}", arguments.out.display()))?;
    Ok(())
}
