//! cargo-deny: licences, banned crates and sources, by the rules of `deny.toml`.
//!
//! Security advisories are left out: they need a database from outside the package registry.

use anyhow::{Result, bail};

use super::Verdict;
use crate::workspace::{Workspace, answers, run};

const HINT: &str = "cargo-deny is not installed (cargo xtask deny --install)";

/// The check as a step: skipped where cargo-deny is missing and is not to be installed.
///
/// # Errors
/// When cargo-deny finds something.
pub fn step(workspace: &Workspace, install: bool) -> Result<Verdict> {
    if !is_installed(workspace) && !install {
        return Ok(Verdict::Skipped(HINT.to_owned()));
    }
    if let Err(error) = provide(workspace) {
        return Ok(Verdict::Skipped(format!("cargo-deny could not be installed: {error:#}")));
    }
    check(workspace, false)?;
    Ok(Verdict::Passed)
}

/// Runs cargo-deny, installing it first when it is missing and `install` is set.
///
/// # Errors
/// When it is missing, cannot be installed, or finds something.
pub fn check(workspace: &Workspace, install: bool) -> Result<()> {
    if install {
        provide(workspace)?;
    } else if !is_installed(workspace) {
        bail!("{HINT}");
    }
    // A rule may name a crate that does not import the banned one today.
    let allowed = ["--allow", "unused-wrapper"];
    run(workspace.cargo().args(["deny", "check"]).args(allowed).args(["licenses", "bans", "sources"]))
}

/// Installs cargo-deny when it is missing.
fn provide(workspace: &Workspace) -> Result<()> {
    if is_installed(workspace) {
        return Ok(());
    }
    run(workspace.cargo().args(["install", "cargo-deny", "--locked"]))
}

fn is_installed(workspace: &Workspace) -> bool {
    answers(workspace.cargo().args(["deny", "--version"]))
}
