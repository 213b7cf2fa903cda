//! `trainer pack`: binds trained skills into a character pack.

use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::Args;
use physics_bridge::Model;
use trainer::checkpoint::{Checkpoint, write_atomically};
use trainer::env::Normalisers;
use trainer::pack::{Ingredient, PackPlan, bind};

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
    checkpoint: &dyn Fn(&str) -> PathBuf,
    a: &Arguments,
) -> Result<()> {
    let mut plan = PackPlan::load(&a.plan)?;
    let joint = plan.joint.as_ref().map(|run| checkpoint(run)).filter(|path| path.exists());
    let joint = joint.map(|path| Checkpoint::load(&path).map(|loaded| (loaded, path))).transpose()?;
    let together = |skill: &str| joint.as_ref().filter(|(loaded, _)| Ingredient::is_in(skill, loaded));
    if a.partial || !a.without.is_empty() {
        let trained = |skill: &str| together(skill).is_some() || checkpoint(skill).exists();
        let left_out = |skill: &str| a.without.iter().any(|w| w == skill) || (a.partial && !trained(skill));
        plan = plan.only(|skill| !left_out(skill));
    }
    let mut ingredients = Vec::new();
    for policy in &plan.policies {
        ingredients.push(match together(&policy.name) {
            Some((loaded, path)) => Ingredient::from_checkpoint(&policy.name, loaded, path)?,
            None => Ingredient::load(&policy.name, &checkpoint(&policy.name))?,
        });
    }
    let pack = bind(&plan, &ingredients, normalisers, model)?;
    write_atomically(&a.out, &pack.to_bytes())
        .with_context(|| format!("cannot write {}", a.out.display()))?;
    for (node, ingredient) in pack.graph().nodes().iter().zip(&ingredients) {
        println!("{:8} {}", node.name, ingredient.origin);
    }
    println!("wrote {}", a.out.display());
    Ok(())
}
