//! `trainer export`: the policies and paths of a pack as ONNX models.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use clap::Args;
use files::read_bounded;
use policy_core::CharacterPack;
use policy_core::format::MAX_PACK_BYTES;
use trainer::onnx::{DEPLOYMENT_FILE, export};

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
    let pack = load(&arguments.pack)?;
    let files = export(&pack, &arguments.onnx)?;
    say(format_args!(
        "wrote {} files to {}, described by {DEPLOYMENT_FILE}",
        files.len(),
        arguments.onnx.display()
    ))
}

/// Reads a pack.
pub(super) fn load(path: &Path) -> Result<CharacterPack> {
    let bytes = read_bounded(path, MAX_PACK_BYTES as u64);
    let bytes = bytes.with_context(|| format!("cannot read {}", path.display()))?;
    CharacterPack::from_bytes(&bytes).with_context(|| format!("cannot load {}", path.display()))
}
