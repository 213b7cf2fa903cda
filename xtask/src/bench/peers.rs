//! Builds and runs `benches/peers`. It is a workspace of its own with one feature for each half, so that only the
//! libraries that are measured get compiled.

use std::process::{Command, Stdio};

use anyhow::Result;

use crate::workspace::{Workspace, run};

/// One half of the peers.
#[derive(Debug, Clone, Copy)]
pub struct Peers {
    /// The feature that brings its libraries.
    pub feature: &'static str,
    /// The benchmark of that half.
    pub bench: &'static str,
}

/// Builds ahead of all measuring, so that everything is measured in one go.
///
/// # Errors
/// When the build fails.
pub fn build(workspace: &Workspace, peers: &Peers) -> Result<()> {
    eprintln!("xtask: building the peers; the first time this takes many minutes");
    run(quiet(cargo_bench(workspace, peers).arg("--no-run")))
}

/// The command that measures with so many threads.
pub fn bench(workspace: &Workspace, peers: &Peers, threads: usize) -> Command {
    let mut command = cargo_bench(workspace, peers);
    command.env("RAYON_NUM_THREADS", threads.to_string());
    command
}

fn cargo_bench(workspace: &Workspace, peers: &Peers) -> Command {
    let mut command = workspace.cargo();
    command
        .args(["bench", "--manifest-path", "benches/peers/Cargo.toml", "--no-default-features"])
        .args(["--features", peers.feature, "--bench", peers.bench])
        .env("CARGO_TARGET_DIR", workspace.target().join("peers"));
    command
}

/// Sends what a command writes to stdout to stderr.
pub fn quiet(command: &mut Command) -> &mut Command {
    command.stdin(Stdio::null()).stdout(Stdio::from(std::io::stderr()))
}
