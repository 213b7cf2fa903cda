//! Runs the demo: set-up, then the release binary `policy-space`, with the arguments of the user.

use std::ffi::{OsStr, OsString};
use std::process::ExitCode;

use anyhow::{Context, Result};

use crate::setup::{self, Purpose};
use crate::workspace::{Workspace, exit_code_of};

/// What `cargo xtask demo --help` says.
pub const HELP: &str = "\
Set up, then run the demo. Every argument but --no-install and --help is passed to it.

Usage: cargo xtask demo [--no-install] [ARGUMENT...]

Paths are relative to the root of the repository.

In a window (needs a display; a gamepad is used when one is there):
  cargo xtask demo

Without a window or a display, under a script of pad input:
  cargo xtask demo --headless
      the tour of the repository for 20 seconds: pictures to out/frames, a report to out/report.json
  cargo xtask demo --headless --script assets/scripts/tour.ron --seconds 20 --report report.json --frames out/

  --no-install       only say which system packages are missing
  --headless         no window
  --script FILE      pad input over time
  --seconds N        how long to simulate (headless)
  --report FILE      where the report goes, as JSON (headless)
  --frames DIR       where the pictures go (headless)
  -- --help          what else the demo itself takes";

/// What `--headless` alone stands for.
const TOUR: [&str; 8] = [
    "--script",
    "assets/scripts/tour.ron",
    "--seconds",
    "20",
    "--report",
    "out/report.json",
    "--frames",
    "out/frames",
];

/// What the user asked of the demo.
#[derive(Debug, PartialEq, Eq)]
struct Request {
    install: bool,
    help: bool,
    arguments: Vec<OsString>,
}

/// Takes out what is ours and fills in the tour where `--headless` stands alone.
fn parse(arguments: Vec<OsString>) -> Request {
    let mut request = Request { install: true, help: false, arguments: Vec::new() };
    let mut ours = true;
    for argument in arguments {
        match argument.to_str() {
            Some("--") if ours => ours = false,
            Some("--no-install") if ours => request.install = false,
            Some("--help" | "-h") if ours => request.help = true,
            _ => request.arguments.push(argument),
        }
    }
    if request.arguments == [OsStr::new("--headless")] {
        request.arguments.extend(TOUR.map(OsString::from));
    }
    request
}

/// Runs the demo and ends with its exit status.
///
/// # Errors
/// When the set-up fails or the demo cannot be started.
pub fn run(workspace: &Workspace, arguments: Vec<OsString>) -> Result<ExitCode> {
    let request = parse(arguments);
    if request.help {
        println!("{HELP}");
        return Ok(ExitCode::SUCCESS);
    }
    setup::prepare(workspace, Purpose::Demo, request.install)?;
    if request.arguments.contains(&OsString::from("out/frames")) {
        let frames = workspace.root().join("out/frames");
        std::fs::create_dir_all(&frames).with_context(|| format!("create {}", frames.display()))?;
    }
    let mut command = workspace.cargo();
    command.args(["run", "--release", "-p", "viewer", "--bin", "policy-space"]);
    if setup::has_sound() {
        command.args(["--features", "sound"]);
    }
    exit_code_of(command.arg("--").args(request.arguments))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn request(words: &[&str]) -> Request {
        parse(words.iter().map(OsString::from).collect())
    }

    #[test]
    fn headless_alone_is_the_tour() {
        let request = request(&["--headless", "--no-install"]);
        assert!(!request.install);
        assert_eq!(request.arguments[0], "--headless");
        assert_eq!(request.arguments[1..], TOUR);
    }

    #[test]
    fn anything_more_is_handed_on_unchanged() {
        let words = ["--headless", "--seconds", "5"];
        assert_eq!(request(&words).arguments, words);
        assert_eq!(request(&[]).arguments, [""; 0]);
    }

    #[test]
    fn after_two_dashes_all_belongs_to_the_demo() {
        let request = request(&["--", "--help", "--no-install"]);
        assert!(request.install && !request.help);
        assert_eq!(request.arguments, ["--help", "--no-install"]);
    }
}
