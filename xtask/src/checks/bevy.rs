//! `engines/bevy`, a workspace of its own with a toolchain of its own: formatting, clippy and the tests without a window.
//!
//! The examples with a window need Bevy's renderer, which takes a quarter of an hour to compile: they are checked, and not built.

use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context, Result, bail};

use super::Verdict;
use crate::workspace::{Workspace, answers, run};

/// Components of the toolchain that the checks use.
const COMPONENTS: [&str; 2] = ["clippy", "rustfmt"];

/// Features that need no renderer, in one set: another set of features would compile most of Bevy again.
const FEATURES: &str = "--features=mujoco,reload";

/// What the examples with a window need. Gamepads are left out: they need the headers of libudev.
const WINDOW: &str = "--features=window,mujoco";

/// Checks the crate `bevy_policy_space`.
///
/// # Errors
/// When its toolchain is missing and can't be installed, or a check fails.
pub fn check(workspace: &Workspace) -> Result<Verdict> {
    let channel = provided(workspace)?;
    run(cargo(workspace, &channel).args(["fmt", "--check"])).context("formatting")?;
    run(cargo(workspace, &channel).args([
        "clippy",
        "--locked",
        FEATURES,
        "--all-targets",
        "--",
        "-D",
        "warnings",
    ]))
    .context("clippy")?;
    run(cargo(workspace, &channel).args([
        "clippy",
        "--locked",
        WINDOW,
        "--examples",
        "--",
        "-D",
        "warnings",
    ]))
    .context("clippy of the examples with a window")?;
    // Without the examples, which clippy has compiled.
    run(cargo(workspace, &channel).args(["test", "--locked", FEATURES, "--lib", "--tests"]))
        .context("tests")?;
    run(cargo(workspace, &channel).args(["test", "--locked", FEATURES, "--doc"]))
        .context("documentation tests")?;
    Ok(Verdict::Passed)
}

/// The folder of the workspace.
pub fn folder(workspace: &Workspace) -> PathBuf {
    workspace.root().join("engines/bevy")
}

/// Cargo of its toolchain, in its folder, building into its own target folder.
pub fn cargo(workspace: &Workspace, channel: &str) -> Command {
    let mut command = Command::new("rustup");
    command.args(["run", channel, "cargo"]).current_dir(folder(workspace));
    // The cargo that runs this program names its own toolchain and compiler.
    for variable in ["CARGO", "RUSTC", "RUSTDOC", "RUSTUP_TOOLCHAIN", "RUSTC_WRAPPER"] {
        command.env_remove(variable);
    }
    command.env("CARGO_TARGET_DIR", folder(workspace).join("target"));
    command
}

/// The toolchain that `rust-toolchain.toml` names.
///
/// # Errors
/// When the file can't be read or names none.
pub fn channel(workspace: &Workspace) -> Result<String> {
    let file = folder(workspace).join("rust-toolchain.toml");
    let text = std::fs::read_to_string(&file).with_context(|| format!("read {}", file.display()))?;
    channel_of(&text)
        .with_context(|| format!("expected a line `channel = \"...\"` in {}, found none", file.display()))
}

/// The toolchain, installed when it is missing.
///
/// # Errors
/// When it can't be installed.
pub fn provided(workspace: &Workspace) -> Result<String> {
    let channel = channel(workspace)?;
    provide(workspace, &channel)?;
    Ok(channel)
}

fn channel_of(text: &str) -> Option<String> {
    let value = text.lines().find_map(|line| line.trim().strip_prefix("channel"))?;
    let value = value.trim_start().strip_prefix('=')?.trim().strip_prefix('"')?.strip_suffix('"')?;
    Some(value.to_owned())
}

/// Installs the toolchain when it is missing.
fn provide(workspace: &Workspace, channel: &str) -> Result<()> {
    let there =
        || ["clippy", "fmt"].iter().all(|tool| answers(cargo(workspace, channel).args([*tool, "--version"])));
    if there() {
        return Ok(());
    }
    eprintln!("xtask: installing Rust {channel} for engines/bevy");
    let mut install = Command::new("rustup");
    install.args(["toolchain", "install", channel, "--profile", "minimal"]);
    for component in COMPONENTS {
        install.args(["--component", component]);
    }
    let installed = run(&mut install);
    if !there() {
        installed?;
        bail!("expected Rust {channel} with clippy and rustfmt, found none after rustup installed it");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_channel_is_read() {
        assert_eq!(channel_of("[toolchain]\nchannel = \"1.97.1\"\n").as_deref(), Some("1.97.1"));
        assert_eq!(channel_of("channel=\"stable\"").as_deref(), Some("stable"));
        assert_eq!(channel_of("[toolchain]\n"), None);
    }

    #[test]
    fn this_workspace_names_one() {
        let channel = channel(&Workspace::find().unwrap()).unwrap();
        assert!(channel.starts_with("1."), "{channel}");
    }
}
