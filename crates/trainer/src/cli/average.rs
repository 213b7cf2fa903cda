//! `trainer average`: one checkpoint out of several of the same sizes.

use std::collections::BTreeMap;
use std::path::PathBuf;

use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use physics_bridge::Model;
use trainer::average::{Averaging, average};
use trainer::checkpoint::Checkpoint;
use trainer::posture::Posture;

use super::output::say;

/// Arguments of the verb.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Checkpoints, at least two; everything but the policies is the first one's.
    #[arg(required = true)]
    checkpoints: Vec<PathBuf>,
    /// File to write, as RUNS/SKILL/checkpoint.safetensors.
    #[arg(long)]
    out: PathBuf,
    /// Weight of each checkpoint, adding up to 1; equal ones by default. One below zero leads away from that checkpoint.
    #[arg(long, value_delimiter = ',', allow_hyphen_values = true)]
    weights: Vec<f64>,
    /// Skills, of those trained together, whose policies stay as they are in the first checkpoint.
    #[arg(long, value_delimiter = ',')]
    except: Vec<String>,
    /// Skill whose policy checkpoints give that trained several skills together, where the first one trained a skill alone.
    #[arg(long)]
    policy: Option<String>,
    /// Offsets of joint targets that the mean gets, radians, as abdomen_y=0.02,right_hip_x=-0.01; a joint that has a side moves the one on
    /// the other side too.
    #[arg(long, value_name = "JOINT=RADIANS", value_delimiter = ',', value_parser = offset)]
    posture: Vec<(String, f64)>,
}

/// A joint and its offset.
fn offset(text: &str) -> Result<(String, f64), String> {
    let expected = || format!("expected JOINT=RADIANS, found {text:?}");
    let (joint, radians) = text.split_once('=').ok_or_else(expected)?;
    Ok((joint.to_owned(), radians.parse().map_err(|_| expected())?))
}

/// Averages. The model is that of the posture.
pub(crate) fn run(model: impl FnOnce() -> Result<Model>, arguments: &Arguments) -> Result<()> {
    let Arguments { weights, except, policy, .. } = arguments;
    let offsets: BTreeMap<String, f64> = arguments.posture.iter().cloned().collect();
    ensure!(offsets.len() == arguments.posture.len(), "--posture: expected each joint once");
    let posture = match offsets.is_empty() {
        true => None,
        false => Some(Posture::new(model()?.skeleton(), &offsets)?),
    };
    let averaging = Averaging { weights, except, policy: policy.as_deref(), posture: posture.as_ref() };
    if let Err([expected, found]) = averaging.check(arguments.checkpoints.len()) {
        bail!("expected {expected}, found {found}");
    }
    let load = |path: &PathBuf| Checkpoint::load(path).map(|checkpoint| (checkpoint, path.clone()));
    let checkpoints = arguments.checkpoints.iter().map(load).collect::<Result<Vec<_>, _>>()?;
    for skill in &arguments.except {
        let known = checkpoints[0].0.networks.contains_key(&format!("{skill}.actor"));
        ensure!(known, "{}: expected a policy of {skill}, found none", arguments.checkpoints[0].display());
    }
    if let Some(folder) = arguments.out.parent() {
        std::fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    }
    average(&checkpoints, averaging)?.save(&arguments.out)?;
    say(format_args!("wrote {}", arguments.out.display()))?;
    Ok(())
}
