//! The checks: the command of each.

use std::path::Path;
use std::process::Command;

use anyhow::{Result, bail, ensure};

use super::{Step, Verdict, bevy, c_interface, deny, imports, words};
use crate::setup;
use crate::workspace::{Workspace, answers, output_of, run};

/// The checks that cargo-deny does.
pub const DENY: &[Step] = &[RULES, ADVISORIES];

const RULES: Step = Step { name: "licences, bans, sources", run: deny::rules };
const ADVISORIES: Step = Step { name: "security advisories", run: deny::advisories };

/// The check of the C interface.
pub const C_INTERFACE: &[Step] = &[C_PROGRAM];

const C_PROGRAM: Step = Step { name: "C interface: gcc, clang", run: c_interface::check };

/// The target of the page.
const WASM: &str = "wasm32-unknown-unknown";

/// All checks in the order in which they run: quick ones first, the tests last, so that a run ends with theirs.
pub const ALL: &[Step] = &[
    Step { name: "formatting", run: formatting },
    Step {
        name: "imports between crates",
        run: |workspace| imports::check(workspace).map(|()| Verdict::Passed),
    },
    Step { name: "names", run: |workspace| words::check(workspace).map(|()| Verdict::Passed) },
    RULES,
    ADVISORIES,
    Step { name: "no_std: wasm32", run: |workspace| no_std(workspace, WASM) },
    Step { name: "no_std: thumbv7em", run: |workspace| no_std(workspace, "thumbv7em-none-eabihf") },
    Step { name: "bits without vector units", run: plain_bits },
    Step { name: "clippy", run: clippy },
    Step { name: "demo with sound", run: sound },
    Step { name: "page: wasm32", run: page },
    C_PROGRAM,
    Step { name: "Rapier: enhanced-determinism", run: determinism },
    Step { name: "engines/bevy", run: bevy::check },
    Step { name: "documentation", run: documentation },
    Step { name: "tests", run: tests_all },
];

/// Tests Rapier's characters with the same bits on every processor.
fn determinism(workspace: &Workspace) -> Result<Verdict> {
    run(workspace.cargo().args(["test", "-p", "physics-rapier", "--features", "enhanced-determinism"]))?;
    Ok(Verdict::Passed)
}

fn formatting(workspace: &Workspace) -> Result<Verdict> {
    require_component(workspace, "fmt", "rustfmt")?;
    run(workspace.cargo().args(["fmt", "--all", "--check"]))?;
    Ok(Verdict::Passed)
}

fn clippy(workspace: &Workspace) -> Result<Verdict> {
    require_component(workspace, "clippy", "clippy")?;
    run(workspace.cargo().args(["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"]))?;
    Ok(Verdict::Passed)
}

/// The demo's feature `sound`, which no other check turns on: it needs the development files of ALSA.
fn sound(workspace: &Workspace) -> Result<Verdict> {
    let missing =
        "expected the development files of ALSA, found none: apt-get install libasound2-dev pkg-config";
    ensure!(setup::has_sound(), missing);
    let of_demo = ["-p", "viewer", "--features", "sound", "--lib"];
    run(workspace.cargo().arg("clippy").args(of_demo).args(["--", "-D", "warnings"]))?;
    run(workspace.cargo().arg("test").args(of_demo).arg("sound::"))?;
    Ok(Verdict::Passed)
}

/// The page's module, a workspace of its own. Playing it needs a browser: `cargo xtask web --check`.
fn page(workspace: &Workspace) -> Result<Verdict> {
    const MANIFEST: &str = "web/Cargo.toml";
    require_target(workspace, WASM)?;
    run(workspace.cargo().args(["fmt", "--check", "--manifest-path", MANIFEST]))?;
    let mut clippy = workspace.cargo();
    clippy.args(["clippy", "--locked", "--target", WASM, "--manifest-path", MANIFEST, "--target-dir"]);
    run(clippy.arg(workspace.target()).args(["--", "-D", "warnings"]))?;
    Ok(Verdict::Passed)
}

fn documentation(workspace: &Workspace) -> Result<Verdict> {
    run(workspace.cargo().args(["doc", "--workspace", "--no-deps"]).env("RUSTDOCFLAGS", "-D warnings"))?;
    Ok(Verdict::Passed)
}

/// All tests. Those in a real window must not be skipped: without what they need all others run, and the check fails.
fn tests_all(workspace: &Workspace) -> Result<Verdict> {
    let mut tests = workspace.cargo();
    tests.args(["test", "--workspace", "--no-fail-fast"]);
    let has_window = setup::has_window();
    if has_window {
        tests.env("POLICY_SPACE_NEED_WINDOW", "1");
    }
    run(&mut tests)?;
    without_window(has_window, cfg!(target_os = "linux"))
}

/// How the tests ended that passed, with those in a real window or without them.
fn without_window(has_window: bool, is_linux: bool) -> Result<Verdict> {
    match (has_window, is_linux) {
        (true, _) => Ok(Verdict::Passed),
        (false, true) => bail!(
            "expected Xvfb, xdotool and a Vulkan driver for the tests in a real window, found not all of them: \
             apt-get install xvfb xdotool libvulkan1 mesa-vulkan-drivers"
        ),
        (false, false) => {
            Ok(Verdict::Skipped("all passed but those in a real window, which are written for Linux".into()))
        }
    }
}

/// Builds policy-core without the standard library for a target that has none.
fn no_std(workspace: &Workspace, target: &str) -> Result<Verdict> {
    require_target(workspace, target)?;
    let arguments = ["build", "-p", "policy-core", "--no-default-features", "--target", target];
    run(workspace.cargo().args(arguments))?;
    Ok(Verdict::Passed)
}

/// Runs the tests of blends, with their pinned bits, on the code for processors without vector units.
fn plain_bits(workspace: &Workspace) -> Result<Verdict> {
    run(workspace.cargo().args(["test", "-p", "policy-core", "--no-default-features", "--test", "blend"]))?;
    Ok(Verdict::Passed)
}

/// Adds a target to the toolchain when it is missing. A check that cannot run has failed.
fn require_target(workspace: &Workspace, target: &str) -> Result<()> {
    if has_target(workspace, target) || run_rustup(&["target", "add", target]) {
        return Ok(());
    }
    bail!("expected the target {target}, found none, and rustup could not add it")
}

/// Whether the compiler has the libraries of a target.
fn has_target(workspace: &Workspace, target: &str) -> bool {
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let folder = output_of(workspace.command(rustc).args(["--print", "target-libdir", "--target", target]));
    folder.is_ok_and(|folder| Path::new(folder.trim()).is_dir())
}

/// Adds the component of a cargo subcommand to the toolchain when it is missing. A check that cannot run has failed.
fn require_component(workspace: &Workspace, subcommand: &str, component: &str) -> Result<()> {
    let there = || answers(workspace.cargo().args([subcommand, "--version"]));
    if there() || (run_rustup(&["component", "add", component]) && there()) {
        return Ok(());
    }
    bail!("expected {component}, found none, and rustup could not add it")
}

fn run_rustup(arguments: &[&str]) -> bool {
    eprintln!("xtask: rustup {}", arguments.join(" "));
    run(Command::new("rustup").args(arguments)).is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tests_that_did_not_run_are_no_tests_that_passed() {
        assert_eq!(without_window(true, true).unwrap(), Verdict::Passed);
        assert!(without_window(false, true).unwrap_err().to_string().contains("apt-get install xvfb"));
        assert!(matches!(without_window(false, false).unwrap(), Verdict::Skipped(_)));
    }
}
