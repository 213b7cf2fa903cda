//! `trainer view`: a clip fitted to the humanoid, told in numbers and written as poses.

use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::Args;
use physics_bridge::Model;
use serde::Serialize;
use trainer::checkpoint::write_atomically;
use trainer::clip::{ClipFolder, load_file};
use trainer::env::fit;

/// Arguments of the verb.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Name of a clip in the folder of clips, or a clip file.
    clip: String,
    /// File to write the poses to: JSON, one list of `qpos` a control tick.
    #[arg(long)]
    poses: Option<PathBuf>,
}

/// Poses at the control rate, for a renderer to play.
#[derive(Serialize)]
struct Poses<'a> {
    format: &'static str,
    clip: &'a str,
    hz: f64,
    qpos: Vec<&'a [f64]>,
}

/// Fits, tells and writes.
pub(crate) fn run(model: &Model, folder: impl Fn() -> Result<ClipFolder>, a: &Arguments) -> Result<()> {
    let file = PathBuf::from(&a.clip);
    let clip = if file.is_file() { load_file(&file)? } else { folder()?.load(&a.clip)? };
    let fitted = fit(&clip, model)?;
    let (radians, joint) = fitted.motion.outside_limits;
    let lowest = fitted.clearances.iter().copied().fold(f32::INFINITY, f32::min);
    println!(
        "{}: {:.2} s, {}, {:.2} m/s, lifted by {:.3} m, then {:.3} m in the ground at worst; \
         leaves its joint limits by at most {:.1} degrees ({joint})",
        clip.name,
        clip.duration(),
        if clip.looping { "loops" } else { "ends" },
        fitted.motion.mean_speed(),
        fitted.lift,
        (-lowest).max(0.0),
        radians.to_degrees(),
    );
    if let Some(path) = &a.poses {
        let stride = trainer::clip::TICK_STRIDE;
        let qpos = fitted.motion.poses.iter().step_by(stride).map(|p| &p.qpos[..]).collect();
        let hz = 1.0 / (fitted.motion.dt_secs * stride as f64);
        let poses = Poses { format: "policy-space poses", clip: &clip.name, hz, qpos };
        let text = serde_json::to_string(&poses)?;
        write_atomically(path, text.as_bytes())
            .with_context(|| format!("cannot write {}", path.display()))?;
        println!("wrote {}", path.display());
    }
    Ok(())
}
