//! `trainer evaluate`: measures a pack.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use anyhow::{Context, Result};
use clap::Args;
use physics_bridge::Model;
use policy_core::CharacterPack;
use trainer::checkpoint::write_atomically;
use trainer::evaluate::{Effort, evaluate};

/// Arguments of the verb.
#[derive(Args)]
pub(crate) struct Arguments {
    /// The pack.
    pack: PathBuf,
    /// File to write the measures to.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Fewer characters and seconds: under a minute.
    #[arg(long)]
    quick: bool,
}

/// Measures.
pub(crate) fn run(model: &Model, arguments: &Arguments) -> Result<()> {
    let path = &arguments.pack;
    let bytes = std::fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
    let pack = CharacterPack::from_bytes(&bytes).with_context(|| path.display().to_string())?;
    let effort = if arguments.quick { Effort::QUICK } else { Effort::FULL };
    let start = Instant::now();
    let evaluation = evaluate(model, &Arc::new(pack), &effort, |what| {
        eprintln!("{:5.0} s {what}", start.elapsed().as_secs_f32());
    });
    let text = serde_json::to_string_pretty(&evaluation)?;
    match &arguments.json {
        Some(path) => {
            write_atomically(path, text.as_bytes())
                .with_context(|| format!("cannot write {}", path.display()))?;
        }
        None => println!("{text}"),
    }
    Ok(())
}
