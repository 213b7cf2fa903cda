//! `trainer import`: policies from ONNX models, back into a pack.

use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::Args;
use files::write_atomically;
use trainer::onnx::import;

use super::load;
use super::output::say;

/// Arguments of the verb.
#[derive(Args)]
pub(crate) struct Arguments {
    /// The pack whose policies and observation normaliser are replaced; everything else of it stays.
    pack: PathBuf,
    /// Folder of models with a deployment file, as `trainer export` writes it.
    #[arg(long, value_name = "DIR")]
    onnx: PathBuf,
    /// File to write; the pack itself when it is not given.
    #[arg(long)]
    out: Option<PathBuf>,
}

/// Imports.
pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let pack = load::pack(&arguments.pack)?;
    let imported = import(&pack, &arguments.onnx)?;
    let out = arguments.out.as_ref().unwrap_or(&arguments.pack);
    write_atomically(out, &imported.to_bytes()).with_context(|| format!("cannot write {}", out.display()))?;
    let changed = pack.policies().iter().zip(imported.policies()).filter(|(a, b)| a != b).count();
    say(format_args!("wrote {}: {changed} of {} policies changed", out.display(), pack.policies().len()))
}
