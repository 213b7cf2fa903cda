//! `trainer export`: the policies and paths of a pack as ONNX models.

use std::path::PathBuf;

use anyhow::Result;
use clap::Args;
use trainer::onnx::{DEPLOYMENT_FILE, export};

use super::load;
use super::output::say;

/// Arguments of the verb.
#[derive(Args)]
pub(crate) struct Arguments {
    /// The pack.
    pack: PathBuf,
    /// Folder to write: one model for each policy, one for each path that takes blend weights, and a deployment file.
    #[arg(long, value_name = "DIR")]
    onnx: PathBuf,
}

/// Exports.
pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let pack = load::pack(&arguments.pack)?;
    let files = export(&pack, &arguments.onnx)?;
    say(format_args!(
        "wrote {} files to {}, described by {DEPLOYMENT_FILE}",
        files.len(),
        arguments.onnx.display()
    ))
}
