//! `bench engines`: a physics step in Rapier and in MuJoCo, and the Bevy plug-in's share of a frame.
//!
//! The contract: the example `bench_step` of `crates/physics` and the example `bench_tick` of `engines/bevy` each print one
//! JSON object with `--json`. The latter is a workspace with a toolchain of its own, which is installed where it is missing.

use std::path::Path;

use anyhow::{Context, Result, ensure};
use serde_json::{Map, Value};

use super::parse_figures;
use crate::checks::bevy;
use crate::workspace::{Workspace, output_of};

const STEPS: [&str; 2] = ["rapier_step_us", "mujoco_step_us"];
const TICKS: [&str; 2] = ["bevy_tick_us_1", "bevy_tick_us_20"];

/// Measures and collects the figures.
///
/// # Errors
/// When the plug-in is missing, a benchmark cannot be built or run, or a figure is missing.
pub fn measure(workspace: &Workspace) -> Result<Map<String, Value>> {
    require_plug_in(&bevy::folder(workspace))?;
    let steps = ["run", "--release", "-p", "physics", "--example", "bench_step", "--", "--json"];
    let steps = output_of(workspace.cargo().args(steps))?;
    let mut figures = parse_figures(&steps, &STEPS).context("read what the example bench_step wrote")?;
    let channel = bevy::provided(workspace)?;
    let mut ticks = bevy::cargo(workspace, &channel);
    let ticks = output_of(ticks.args(["run", "--release", "--example", "bench_tick", "--", "--json"]))
        .with_context(|| format!("run bench_tick of engines/bevy with Rust {channel}"))?;
    figures.append(&mut parse_figures(&ticks, &TICKS).context("read what the example bench_tick wrote")?);
    figures.retain(|name, _| STEPS.iter().chain(&TICKS).any(|promised| promised == name));
    Ok(figures)
}

/// Refuses a folder without the plug-in.
fn require_plug_in(folder: &Path) -> Result<()> {
    let there = folder.join("Cargo.toml").is_file();
    ensure!(there, "expected the Bevy plug-in in {}, found no Cargo.toml there", folder.display());
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::workspace::ScratchFolder;

    #[test]
    fn a_missing_plug_in_is_named_before_anything_is_built() {
        let root = ScratchFolder::new("bench-engines");
        let message = require_plug_in(root.path()).unwrap_err().to_string();
        assert!(message.contains("bench-engines") && message.contains("Cargo.toml"), "{message}");
        std::fs::write(root.path().join("Cargo.toml"), "[workspace]\n").unwrap();
        require_plug_in(root.path()).unwrap();
    }

    #[test]
    fn figures_of_both_programs_have_their_agreed_names() {
        let steps = parse_figures("{\"mujoco_step_us\": 13.0, \"rapier_step_us\": 175.2}", &STEPS).unwrap();
        assert_eq!(steps["rapier_step_us"], 175.2);
        let message = parse_figures("{\"bevy_tick_us_1\": 800.0}", &TICKS).unwrap_err().to_string();
        assert!(message.contains("bevy_tick_us_20"), "{message}");
    }
}
