//! Runs the fuzz targets of `fuzz/`, one after the other.
//!
//! They need a nightly compiler, so they are no part of the checks.

use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};
use clap::Args;

use crate::setup::{self, Purpose};
use crate::workspace::{Workspace, answers, run as run_command};

/// What can be said about fuzzing.
#[derive(Debug, Args)]
pub struct FuzzArgs {
    /// The target to run; all of them when none is named.
    target: Option<String>,
    /// Minutes for each target.
    #[arg(long, default_value_t = 10.0)]
    minutes: f64,
}

/// Runs one target or all of them.
///
/// # Errors
/// When the tools are missing, the target is unknown, or a target found an input that breaks it.
pub fn run(workspace: &Workspace, arguments: &FuzzArgs) -> Result<()> {
    let targets = chosen(&targets(workspace.root())?, arguments.target.as_deref())?;
    let seconds = arguments.minutes * 60.0;
    ensure!((1.0..1e6).contains(&seconds), "expected minutes above 0, found {}", arguments.minutes);
    if !answers(Command::new("rustup").args(["run", "nightly", "cargo", "fuzz", "--version"])) {
        bail!(
            "fuzzing needs a nightly toolchain and cargo-fuzz:\n    rustup toolchain install nightly\n    \
             cargo install cargo-fuzz"
        );
    }
    setup::prepare(workspace, Purpose::Demo, false)?;
    for target in targets {
        eprintln!("xtask: fuzzing {target} for {} minutes", arguments.minutes);
        // Whatever toolchain runs this program must not be forced upon the nightly cargo.
        run_command(
            workspace
                .command("rustup")
                .env_remove("RUSTUP_TOOLCHAIN")
                .env_remove("CARGO")
                .args(["run", "nightly", "cargo", "fuzz", "run", &target, "--"])
                .arg(format!("-max_total_time={seconds:.0}")),
        )?;
    }
    Ok(())
}

/// The names of all targets, sorted.
fn targets(root: &Path) -> Result<Vec<String>> {
    let folder = root.join("fuzz/fuzz_targets");
    let mut names = Vec::new();
    for entry in std::fs::read_dir(&folder).with_context(|| format!("list {}", folder.display()))? {
        let path = entry?.path();
        if path.extension().is_some_and(|extension| extension == "rs") {
            names.extend(path.file_stem().map(|stem| stem.to_string_lossy().into_owned()));
        }
    }
    names.sort();
    Ok(names)
}

fn chosen(targets: &[String], asked: Option<&str>) -> Result<Vec<String>> {
    match asked {
        None => Ok(targets.to_vec()),
        Some(name) if targets.iter().any(|target| target == name) => Ok(vec![name.to_owned()]),
        Some(name) => bail!("no fuzz target {name}; there are: {}", targets.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::workspace::ScratchFolder;

    #[test]
    fn targets_are_the_sources_of_the_folder() {
        let folder = ScratchFolder::new("fuzz");
        let sources = folder.path().join("fuzz/fuzz_targets");
        std::fs::create_dir_all(&sources).unwrap();
        for name in ["script.rs", "pack.rs", "notes.md"] {
            std::fs::write(sources.join(name), "").unwrap();
        }
        assert_eq!(targets(folder.path()).unwrap(), ["pack", "script"]);
    }

    #[test]
    fn an_unknown_target_is_refused_with_the_known_ones() {
        let known = ["pack".to_owned(), "script".to_owned()];
        assert_eq!(chosen(&known, None).unwrap(), known);
        assert_eq!(chosen(&known, Some("pack")).unwrap(), ["pack"]);
        assert!(chosen(&known, Some("pak")).unwrap_err().to_string().contains("pack, script"));
    }
}
