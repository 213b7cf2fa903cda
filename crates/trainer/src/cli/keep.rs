//! `trainer keep`: slim checkpoints of runs and the normaliser, to start other runs from.

use std::path::Path;

use anyhow::{Context, Result};
use clap::Args;
use trainer::env::Normalisers;
use trainer::normaliser_file;
use trainer::run::newest_checkpoint;

use super::output::say;

/// Arguments of the verb.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Skills to keep.
    #[arg(required = true)]
    skills: Vec<String>,
}

/// Keeps.
pub(crate) fn run(normalisers: &Normalisers, runs: &Path, kept: &Path, arguments: &Arguments) -> Result<()> {
    std::fs::create_dir_all(kept).with_context(|| format!("cannot make {}", kept.display()))?;
    for skill in &arguments.skills {
        let folder = runs.join(skill);
        let loaded = newest_checkpoint(&folder)?;
        let checkpoint =
            loaded.with_context(|| format!("expected a run in {}", folder.display()))?.checkpoint;
        let path = kept.join(format!("{skill}.safetensors"));
        checkpoint.slim().save(&path)?;
        say(format_args!("wrote {}", path.display()))?;
    }
    normaliser_file::save(&kept.join("normaliser.safetensors"), normalisers)?;
    Ok(())
}
