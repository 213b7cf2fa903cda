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
/// When cargo-deny finds something or cannot be installed.
pub fn step(workspace: &Workspace, install: bool) -> Result<Verdict> {
    if !is_installed(workspace) && !install {
        return Ok(Verdict::Skipped(HINT.to_owned()));
    }
    check(workspace, install)?;
    Ok(Verdict::Passed)
}

/// Runs cargo-deny, installing it first when it is missing and `install` is set.
///
/// # Errors
/// When it is missing, cannot be installed, or finds something.
pub fn check(workspace: &Workspace, install: bool) -> Result<()> {
    if !is_installed(workspace) {
        if !install {
            bail!("{HINT}");
        }
        run(workspace.cargo().args(["install", "cargo-deny", "--locked"]))?;
    }
    run(workspace.cargo().args(["deny", "--all-features", "check", "licenses", "bans", "sources"]))
}

fn is_installed(workspace: &Workspace) -> bool {
    answers(workspace.cargo().args(["deny", "--version"]))
}
