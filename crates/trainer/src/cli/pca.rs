//! `trainer pca`: the paper's figures 5 (visited states) and 6 (parameters), as pictures and as CSV, and the correlation
//! between distances of parameters and of states.

use std::path::PathBuf;
use std::sync::Arc;

use anyhow::{Context, Result};
use clap::Args;
use evaluation::maps::Maps;
use files::write_atomically;
use physics::Engine;
use physics_bridge::Model;

use super::output::say;

/// Arguments of the verb.
#[derive(Args)]
pub(crate) struct Arguments {
    /// The pack.
    pack: PathBuf,
    /// Folder for `states` and `parameters`, each as .csv and .svg.
    #[arg(long, default_value = "out/pca")]
    out: PathBuf,
    /// Seconds that each policy is watched.
    #[arg(long, default_value_t = 20.0)]
    secs: f32,
}

/// Computes and writes.
pub(crate) fn run(model: &Model, arguments: &Arguments) -> Result<()> {
    let path = &arguments.pack;
    let pack = Arc::new(super::load::pack(path)?);
    std::fs::create_dir_all(&arguments.out)?;
    let model = physics::Model::new(model, Engine::Mujoco)?;
    let maps = Maps::of(&model, &pack, arguments.secs)
        .with_context(|| format!("{}: expected a path, found none", path.display()))?;
    for (name, map) in [("states", &maps.states), ("parameters", &maps.parameters)] {
        write_atomically(&arguments.out.join(format!("{name}.csv")), map.csv().as_bytes())?;
        map.draw(&arguments.out.join(format!("{name}.svg")))?;
        say(format_args!("{name}: two components hold {:.0} % of the variance", 100.0 * map.share()))?;
    }
    say(format_args!("correlation of distances: {:.2}", maps.correlation()))?;
    say(format_args!("wrote {}", arguments.out.display()))?;
    Ok(())
}
