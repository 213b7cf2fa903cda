//! Makes a fresh machine ready: system packages and libmujoco. Quick and silent when nothing is missing.
//!
//! The demo, the tests and the benchmarks run it first. Tried on Debian 12 (x86_64). The code for arm64, macOS and
//! Windows is written and their wheels are pinned, but it has not been run.

mod download;
#[cfg(windows)]
mod import_library;
mod library;
mod packages;
mod pins;

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

pub use download::remove_folder;
pub use packages::{Purpose, has_sound, has_window};

use self::library::Installation;
use crate::workspace::Workspace;

/// Where cargo's environment says that libmujoco lies; `.cargo/config.toml` sets it to our own folder.
const LINK_VARIABLE: &str = "MUJOCO_DYNAMIC_LINK_DIR";

/// Installs or names missing packages and fetches libmujoco.
///
/// # Errors
/// When libmujoco is not there and cannot be fetched.
pub fn prepare(workspace: &Workspace, purpose: Purpose, install: bool) -> Result<()> {
    packages::prepare(purpose, install);
    if let Some(folder) = foreign_folder(workspace) {
        eprintln!("xtask: using libmujoco from {} ({LINK_VARIABLE})", folder.display());
        return Ok(());
    }
    Installation::new(&pins::MUJOCO, workspace.third_party())?.ensure().context("set-up of libmujoco")
}

/// Folders of libmujoco's library and of its headers. [`prepare`] has to run before.
pub fn mujoco_folders(workspace: &Workspace) -> (PathBuf, PathBuf) {
    let library = foreign_folder(workspace).unwrap_or_else(|| workspace.third_party().join("mujoco/lib"));
    let headers = library.parent().unwrap_or(Path::new(".")).join("include");
    (library, headers)
}

/// Fetches ONNX Runtime, which only the benchmark of peers uses, and returns its library file.
///
/// # Errors
/// When it is not there and cannot be fetched.
pub fn onnx_runtime(workspace: &Workspace) -> Result<PathBuf> {
    let installation = Installation::new(&pins::ONNX_RUNTIME, workspace.third_party())?;
    installation.ensure().context("set-up of ONNX Runtime")?;
    Ok(installation.library_file())
}

/// The user's own folder of libmujoco, if the environment names one.
fn foreign_folder(workspace: &Workspace) -> Option<PathBuf> {
    let folder = PathBuf::from(std::env::var_os(LINK_VARIABLE)?);
    let ours = workspace.third_party().join("mujoco/lib");
    (!same_path(&folder, &ours)).then_some(folder)
}

fn same_path(one: &Path, other: &Path) -> bool {
    one == other || matches!((one.canonicalize(), other.canonicalize()), (Ok(one), Ok(other)) if one == other)
}
