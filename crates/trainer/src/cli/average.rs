//! `trainer average`: one checkpoint out of several of the same run.

use std::path::PathBuf;

use anyhow::{Context, Result, ensure};
use clap::Args;
use trainer::average::average;
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
    /// Skills, of those trained together, whose policies stay as they are in the first checkpoint.
    #[arg(long, value_delimiter = ',')]
    except: Vec<String>,
}

/// Averages.
pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    ensure!(arguments.checkpoints.len() > 1, "expected at least two checkpoints, found one");
    let load = |path: &PathBuf| Checkpoint::load(path).map(|checkpoint| (checkpoint, path.clone()));
    let checkpoints = arguments.checkpoints.iter().map(load).collect::<Result<Vec<_>, _>>()?;
    for skill in &arguments.except {
        let known = checkpoints[0].0.networks.contains_key(&format!("{skill}.actor"));
        ensure!(known, "{}: expected a policy of {skill}, found none", arguments.checkpoints[0].display());
    }
    if let Some(folder) = arguments.out.parent() {
        std::fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    }
    average(&checkpoints, &arguments.except)?.save(&arguments.out)?;
    say(format_args!("wrote {}", arguments.out.display()))?;
    Ok(())
}
