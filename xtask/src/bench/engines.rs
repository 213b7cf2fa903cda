//! `bench engines`: a physics step in Rapier and in MuJoCo, and the Bevy plug-in's share of a frame.
//!
//! The contract: the example `bench_step` of `crates/physics` and the example `bench_tick` of `engines/bevy` each print one
//! JSON object with `--json`. The latter is a workspace with a toolchain of its own.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use serde_json::{Map, Value};

use super::parse_figures;
use crate::workspace::{Workspace, output_of};

const STEPS: [&str; 2] = ["rapier_step_us", "mujoco_step_us"];
const TICKS: [&str; 2] = ["bevy_tick_us_1", "bevy_tick_us_20"];

/// Where the plug-in is, in the workspace's root.
const PLUG_IN: &str = "engines/bevy";

/// The toolchain that Bevy needs.
const TOOLCHAIN: &str = "1.97.1";

/// Measures and collects the figures.
///
/// # Errors
/// When the plug-in is missing, a benchmark cannot be built or run, or a figure is missing.
pub fn measure(workspace: &Workspace) -> Result<Map<String, Value>> {
    let plug_in = plug_in(workspace.root())?;
    let steps = ["run", "--release", "-p", "physics", "--example", "bench_step", "--", "--json"];
    let steps = output_of(workspace.cargo().args(steps))?;
    let mut figures = parse_figures(&steps, &STEPS).context("read what the example bench_step wrote")?;
    let arguments =
        ["run", TOOLCHAIN, "cargo", "run", "--release", "--example", "bench_tick", "--", "--json"];
    let mut ticks = workspace.command("rustup");
    // Whatever toolchain runs this program must not be forced upon the plug-in.
    ticks.args(arguments).current_dir(plug_in).env_remove("RUSTUP_TOOLCHAIN").env_remove("CARGO");
    let ticks = output_of(&mut ticks)
        .with_context(|| format!("run bench_tick of {PLUG_IN} with the toolchain {TOOLCHAIN}"))?;
    figures.append(&mut parse_figures(&ticks, &TICKS).context("read what the example bench_tick wrote")?);
    figures.retain(|name, _| STEPS.iter().chain(&TICKS).any(|promised| promised == name));
    Ok(figures)
}

/// The folder of the plug-in.
fn plug_in(root: &Path) -> Result<PathBuf> {
    let folder = root.join(PLUG_IN);
    let there = folder.join("Cargo.toml").is_file();
    ensure!(there, "expected the Bevy plug-in in {}, found no Cargo.toml there", folder.display());
    Ok(folder)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::workspace::ScratchFolder;

    #[test]
    fn a_missing_plug_in_is_named_before_anything_is_built() {
        let root = ScratchFolder::new("bench-engines");
        let message = plug_in(root.path()).unwrap_err().to_string();
        assert!(message.contains(PLUG_IN) && message.contains("Cargo.toml"), "{message}");
        std::fs::create_dir_all(root.path().join(PLUG_IN)).unwrap();
        std::fs::write(root.path().join(PLUG_IN).join("Cargo.toml"), "[workspace]\n").unwrap();
        assert_eq!(plug_in(root.path()).unwrap(), root.path().join(PLUG_IN));
    }

    #[test]
    fn figures_of_both_programs_have_their_agreed_names() {
        let steps = parse_figures("{\"mujoco_step_us\": 13.0, \"rapier_step_us\": 175.2}", &STEPS).unwrap();
        assert_eq!(steps["rapier_step_us"], 175.2);
        let message = parse_figures("{\"bevy_tick_us_1\": 800.0}", &TICKS).unwrap_err().to_string();
        assert!(message.contains("bevy_tick_us_20"), "{message}");
    }
}
