//! cargo-deny: licences, banned crates, sources and security advisories, by the rules of `deny.toml`.
//!
//! Installs its own pinned cargo-deny in `third_party/tools` and uses no other. A cargo-deny that cannot be
//! installed fails the check. Only the advisories may be skipped, and only when their database cannot be reached.

use std::net::{TcpStream, ToSocketAddrs};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use anyhow::{Context, Result, bail};

use super::Verdict;
use crate::setup::remove_folder;
use crate::workspace::{Workspace, answers, output_of, run, status_of};

/// The version that is installed. A new one is a deliberate change: its checks may differ.
const VERSION: &str = "0.20.2";

/// Where the advisory database is fetched from; the default of cargo-deny.
const DATABASE_HOST: &str = "github.com";

/// The workspace of the Bevy plug-in, with a `deny.toml` of its own: it draws and opens windows.
const PLUG_IN: [&str; 2] = ["--manifest-path", "engines/bevy/Cargo.toml"];

/// Runs the checks that need no network: licences, banned crates and sources.
///
/// # Errors
/// When cargo-deny cannot be installed or finds something.
pub fn rules(workspace: &Workspace) -> Result<Verdict> {
    provide(workspace)?;
    // A rule may name a crate that does not import the banned one today.
    let rules = ["check", "--allow", "unused-wrapper", "licenses", "bans", "sources"];
    run(deny(workspace).args(rules))?;
    run(deny(workspace).args(PLUG_IN).args(rules)).context("engines/bevy")?;
    Ok(Verdict::Passed)
}

/// Fetches the advisory database and checks every dependency against it.
///
/// Without a network it uses the copy of an earlier run. Without that copy the check is skipped.
///
/// # Errors
/// When cargo-deny cannot be installed, the fetch fails although the network works, or an advisory applies.
pub fn advisories(workspace: &Workspace) -> Result<Verdict> {
    provide(workspace)?;
    let fetched = status_of(deny(workspace).args(["fetch", "db"]))?.success();
    if !fetched && is_reachable(DATABASE_HOST) {
        bail!("the advisory database could not be fetched, although {DATABASE_HOST} can be reached");
    }
    let copies = workspace.third_party().join("advisory-dbs");
    if !fetched && !has_copy(&copies) {
        return Ok(Verdict::Skipped(format!(
            "no network: {DATABASE_HOST}, which has the advisory database, cannot be reached, and {} has no copy",
            copies.display()
        )));
    }
    if !fetched {
        eprintln!("xtask: no network to {DATABASE_HOST}; checking with the advisories of the last fetch");
    }
    run(deny(workspace).args(["--offline", "check", "advisories"]))?;
    run(deny(workspace).args(PLUG_IN).args(["--offline", "check", "advisories"])).context("engines/bevy")?;
    Ok(Verdict::Passed)
}

/// Installs the pinned cargo-deny when it is missing.
///
/// # Errors
/// When it cannot be compiled, or is another version afterwards.
fn provide(workspace: &Workspace) -> Result<()> {
    if is_installed(workspace) {
        return Ok(());
    }
    eprintln!("xtask: installing cargo-deny {VERSION}, once; takes about two minutes on two cores");
    let build = workspace.target().join("tools");
    let package = format!("cargo-deny@{VERSION}");
    run(cheap(workspace.cargo().args(["install", "--locked", "--force", &package, "--root"]))
        .arg(home(workspace))
        .arg("--target-dir")
        .arg(&build))
    .with_context(|| format!("cargo-deny {VERSION} could not be installed; is there a network?"))?;
    if !is_installed(workspace) {
        bail!("expected cargo-deny {VERSION} in {}, found another", home(workspace).display());
    }
    remove_folder(&build)
}

/// Makes cargo compile quickly instead of well: a slow cargo-deny still takes only seconds.
fn cheap(command: &mut Command) -> &mut Command {
    let profile = [("OPT_LEVEL", "0"), ("LTO", "off"), ("DEBUG", "0"), ("CODEGEN_UNITS", "256")];
    command.envs(profile.map(|(name, value)| (format!("CARGO_PROFILE_RELEASE_{name}"), value)))
}

/// The folder of tools that this workspace installs for itself.
fn home(workspace: &Workspace) -> PathBuf {
    workspace.third_party().join("tools")
}

fn deny(workspace: &Workspace) -> Command {
    let program = format!("cargo-deny{}", std::env::consts::EXE_SUFFIX);
    let mut command = workspace.command(home(workspace).join("bin").join(program));
    // Git must not wait for a password when a fetch is refused.
    command.env("GIT_TERMINAL_PROMPT", "0");
    command
}

fn is_installed(workspace: &Workspace) -> bool {
    answers(deny(workspace).arg("--version"))
        && output_of(deny(workspace).arg("--version")).is_ok_and(|text| is_pinned(&text))
}

fn is_pinned(version_text: &str) -> bool {
    version_text.split_whitespace().last() == Some(VERSION)
}

/// Whether the folder of databases holds one, not only the lock of an attempt.
fn has_copy(databases: &Path) -> bool {
    let entries = std::fs::read_dir(databases).into_iter().flatten().flatten();
    entries.into_iter().any(|entry| entry.path().join("crates").is_dir())
}

/// Whether a host takes connections for HTTPS.
fn is_reachable(host: &str) -> bool {
    let addresses = (host, 443).to_socket_addrs().into_iter().flatten();
    addresses.take(4).any(|address| TcpStream::connect_timeout(&address, Duration::from_secs(5)).is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::workspace::ScratchFolder;

    #[test]
    fn only_the_pinned_version_counts_as_installed() {
        assert!(is_pinned(&format!("cargo-deny {VERSION}\n")));
        assert!(!is_pinned("cargo-deny 0.1.0\n") && !is_pinned(""));
    }

    #[test]
    fn the_lock_of_a_failed_fetch_is_no_database() {
        let folder = ScratchFolder::new("advisory-dbs");
        assert!(!has_copy(&folder.path().join("missing")));
        std::fs::write(folder.path().join("db.lock"), "").unwrap();
        assert!(!has_copy(folder.path()));
        std::fs::create_dir_all(folder.path().join("advisory-db-1/crates")).unwrap();
        assert!(has_copy(folder.path()));
    }

    #[test]
    fn a_name_that_cannot_resolve_is_not_reachable() {
        assert!(!is_reachable("no-such-host.invalid"));
    }
}
