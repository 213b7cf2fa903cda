//! `rapier-patch`: a copy of Rapier's source with this project's patch, for a game that wants it faster.
//!
//! The patch leaves zeros out of the mass matrix (`crates/physics-rapier/patches`). Nothing here builds on the copy by
//! itself: a game names it in its own `Cargo.toml`.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use clap::Args;
use serde_json::Value;

use crate::workspace::{Workspace, copy_folder, output_of, run as run_command};

/// The crate that is patched.
const CRATE: &str = "rapier3d";

/// The patch, from the workspace's root.
const PATCH: &str = "crates/physics-rapier/patches/sparse-mass-matrix.patch";

/// Arguments of `cargo xtask rapier-patch`.
#[derive(Debug, Args)]
pub struct RapierPatchArgs {
    /// Where to put the source; third_party/rapier3d when none is named.
    #[arg(long)]
    into: Option<PathBuf>,
}

/// Copies the source that cargo fetched, patches it, and says how to use it.
///
/// # Errors
/// When cargo has no source of Rapier, the folder holds something else, or the patch does not fit.
pub fn run(workspace: &Workspace, arguments: &RapierPatchArgs) -> Result<()> {
    let into = arguments.into.clone().unwrap_or_else(|| workspace.third_party().join(CRATE));
    let metadata = output_of(workspace.cargo().args(["metadata", "--locked", "--format-version", "1"]))?;
    let from = source_of(&metadata, CRATE)?;
    clear(&into)?;
    copy_folder(&from, &into)?;
    let into = into.canonicalize().with_context(|| into.display().to_string())?;
    // Outside of any repository git takes paths as they are.
    let ceiling = into.parent().unwrap_or(&into).to_path_buf();
    let mut apply = workspace.command("git");
    apply.arg("apply").arg(workspace.root().join(PATCH)).current_dir(&into);
    run_command(apply.env("GIT_CEILING_DIRECTORIES", ceiling)).context("apply the patch to Rapier")?;
    eprintln!("xtask: put this into the Cargo.toml of the game's workspace:");
    println!("[patch.crates-io]\n{CRATE} = {{ path = \"{}\" }}", into.display());
    Ok(())
}

/// The folder of a crate's source, from what `cargo metadata` wrote.
fn source_of(metadata: &str, name: &str) -> Result<PathBuf> {
    let metadata: Value = serde_json::from_str(metadata).context("read what cargo metadata wrote")?;
    let packages = metadata["packages"].as_array().map(Vec::as_slice).unwrap_or_default();
    let package = packages.iter().find(|package| package["name"] == name);
    let manifest = package.and_then(|package| package["manifest_path"].as_str()).map(Path::new);
    let folder = manifest.and_then(Path::parent);
    Ok(folder.with_context(|| format!("expected {name} among the dependencies, found none"))?.to_path_buf())
}

/// Removes an earlier copy, and nothing else.
fn clear(into: &Path) -> Result<()> {
    if !into.exists() {
        return Ok(());
    }
    let manifest = fs::read_to_string(into.join("Cargo.toml")).unwrap_or_default();
    let is_copy = manifest.lines().any(|line| line.trim() == format!("name = \"{CRATE}\""));
    ensure!(is_copy, "expected no folder or a copy of {CRATE} in {}, found something else", into.display());
    fs::remove_dir_all(into).with_context(|| format!("remove {}", into.display()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::workspace::ScratchFolder;

    #[test]
    fn the_source_is_found_by_name() {
        let metadata = r#"{"packages": [{"name": "a", "manifest_path": "/r/a-1/Cargo.toml"}]}"#;
        assert_eq!(source_of(metadata, "a").unwrap(), Path::new("/r/a-1"));
        let message = source_of(metadata, "b").unwrap_err().to_string();
        assert!(message.contains("expected b"), "{message}");
    }

    #[test]
    fn only_a_copy_of_the_crate_is_removed() {
        let root = ScratchFolder::new("rapier-patch");
        let into = root.path().join("into");
        clear(&into).unwrap();
        fs::create_dir_all(&into).unwrap();
        fs::write(into.join("Cargo.toml"), "[package]\nname = \"game\"\n").unwrap();
        assert!(clear(&into).unwrap_err().to_string().contains("found something else"));
        fs::write(into.join("Cargo.toml"), "[package]\nname = \"rapier3d\"\n").unwrap();
        clear(&into).unwrap();
        assert!(!into.exists());
    }
}
