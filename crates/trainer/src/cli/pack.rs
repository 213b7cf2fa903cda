//! `trainer pack`: binds trained skills into a character pack.

use std::path::PathBuf;

use anyhow::{Context, Result, ensure};
use clap::Args;
use physics_bridge::Model;
use trainer::checkpoint::{Checkpoint, CheckpointError};
use trainer::env::Normalisers;
use trainer::pack::{PackPlan, PlannedPolicy, TrainedSkill, bind};
use trainer::storage::write_atomically;

use super::output::say;

/// Arguments of the verb.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Nodes, edges, paths and skills of the pack.
    #[arg(long, default_value = "assets/recipes/pack/humanoid.toml")]
    plan: PathBuf,
    /// File to write.
    #[arg(long, default_value = "assets/humanoid.pack.safetensors")]
    out: PathBuf,
    /// Leave out skills that are not trained yet.
    #[arg(long)]
    partial: bool,
    /// Skills to leave out though they are trained.
    #[arg(long, value_delimiter = ',')]
    without: Vec<String>,
}

/// Binds.
pub(crate) fn run(
    model: &Model,
    normalisers: &Normalisers,
    newest: &dyn Fn(&str) -> Result<Option<(Checkpoint, PathBuf)>, CheckpointError>,
    a: &Arguments,
) -> Result<()> {
    let mut plan = PackPlan::load(&a.plan)?;
    let joint = plan.joint.as_ref().map(|run| newest(run)).transpose()?.flatten();
    let together = |skill: &str| joint.as_ref().filter(|(loaded, _)| TrainedSkill::is_in(skill, loaded));
    let mut trained = Vec::new();
    for PlannedPolicy { name, .. } in &plan.policies {
        let own = match together(name) {
            Some((loaded, path)) => Some(TrainedSkill::from_checkpoint(name, loaded, path)?),
            None => newest(name)?
                .map(|(loaded, path)| TrainedSkill::from_checkpoint(name, &loaded, &path))
                .transpose()?,
        };
        let known = own.is_some();
        trained.extend(own);
        ensure!(
            known || a.partial,
            "expected {name} to be trained, found no checkpoint: leave it out by --partial"
        );
    }
    trained.retain(|t| !a.without.contains(&t.skill));
    plan = plan.only(|skill| trained.iter().any(|t| t.skill == skill));
    let skills = trained;
    let pack = bind(&plan, &skills, normalisers, model)?;
    write_atomically(&a.out, &pack.to_bytes())
        .with_context(|| format!("cannot write {}", a.out.display()))?;
    for (node, ingredient) in pack.graph().nodes().iter().zip(&skills) {
        say(format_args!("{:8} {}", node.name, ingredient.origin))?;
    }
    say(format_args!("wrote {}", a.out.display()))?;
    Ok(())
}
