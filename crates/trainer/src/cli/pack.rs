//! `trainer pack`: binds trained skills into a character pack.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use clap::Args;
use evaluation::{measure_get_up, measure_skill};
use files::{read_bounded, write_atomically};
use physics::Engine;
use physics_bridge::Model;
use policy_core::{CharacterPack, ControllerConfig, SkillId};
use trainer::checkpoint::CheckpointError;
use trainer::env::Normalisers;
use trainer::pack::{Agreement, PackPlan, TrainedSkill, bind, distil, trained_policy};
use trainer::workspace::CheckpointFile;

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
    /// Skinned mesh to put into the pack, a binary glTF file whose nodes are named like the bodies.
    #[arg(long, value_name = "GLB")]
    mesh: Option<PathBuf>,
    /// Keep the discriminators of the training instead of small ones distilled from them.
    #[arg(long)]
    large_discriminators: bool,
    /// Rollouts of each skill that small discriminators learn from, 1 to 10000.
    #[arg(long, default_value_t = 96, value_parser = clap::value_parser!(u16).range(1..=10_000))]
    rollouts: u16,
    /// Measure the skills with large and with small discriminators, so many tries each.
    #[arg(long, value_name = "TRIES")]
    check: Option<usize>,
}

/// Largest mesh, bytes.
const MOST_MESH_BYTES: u64 = 64 << 20;

/// Binds.
pub(crate) fn run(
    model: &Model,
    normalisers: &Normalisers,
    newest: &dyn Fn(&str) -> Result<Option<CheckpointFile>, CheckpointError>,
    a: &Arguments,
) -> Result<()> {
    let mut plan = PackPlan::load(&a.plan)?;
    let joint = plan.joint.as_ref().map(|run| newest(run)).transpose()?.flatten();
    let mut trained: Vec<TrainedSkill> = Vec::new();
    for policy in &plan.policies {
        let name = &policy.name;
        let own = trained_policy(policy, joint.as_slice(), newest)?;
        let known = own.is_some();
        trained.extend(own);
        ensure!(
            known || a.partial,
            "expected {name} to be trained, found no checkpoint: leave it out by --partial"
        );
    }
    trained.retain(|t| !a.without.contains(&t.skill));
    plan = plan.only(|skill| trained.iter().any(|t| t.skill == skill));
    let read_mesh = |path: &PathBuf| {
        read_bounded(path, MOST_MESH_BYTES).with_context(|| format!("cannot read {}", path.display()))
    };
    let mesh = a.mesh.as_ref().map(read_mesh).transpose()?;
    let mut pack = Arc::new(bind(&plan, &trained, normalisers, model, mesh.clone())?);
    if !a.large_discriminators {
        let tries = a.check.unwrap_or_default();
        report_skills(model, &pack, "large", tries)?;
        for (name, network, agreement) in distil(model, &pack, &trained, a.rollouts.into()) {
            let Agreement { rows, same_side, score_error } = agreement;
            say(format_args!(
                "discriminator of {name}: {:?}, {:.1} % of {rows} rows on the same side of the threshold, scores \
                 differ by {score_error:.3}",
                network.sizes(),
                100.0 * same_side
            ))?;
            let large = trained.iter_mut().find(|t| t.skill == name);
            large.into_iter().for_each(|t| t.discriminator.clone_from(&network));
        }
        pack = Arc::new(bind(&plan, &trained, normalisers, model, mesh)?);
        report_skills(model, &pack, "small", tries)?;
    }
    let bytes = pack.to_bytes();
    write_atomically(&a.out, &bytes).with_context(|| format!("cannot write {}", a.out.display()))?;
    for (node, skill) in pack.graph().nodes().iter().zip(&trained) {
        say(format_args!("{:12} {}", node.name, skill.origin))?;
    }
    // The least disturbed of some loads.
    let mut ms = f32::INFINITY;
    for _ in 0..9 {
        let start = Instant::now();
        CharacterPack::from_bytes(&bytes).with_context(|| format!("cannot load {}", a.out.display()))?;
        ms = ms.min(1e3 * start.elapsed().as_secs_f32());
    }
    say(format_args!("wrote {}, {} bytes, loaded in {ms:.1} ms", a.out.display(), bytes.len()))
}

/// Prints how the skills of a pack end.
fn report_skills(model: &Model, pack: &Arc<CharacterPack>, which: &str, tries: usize) -> Result<()> {
    let model = &physics::Model::new(model, Engine::Mujoco)?;
    for (index, skill) in pack.skills().iter().enumerate().filter(|_| tries > 0) {
        let id = SkillId::new(index);
        let report = match pack.recovery() == Some(id) {
            true => measure_get_up(model, pack, &skill.name, tries).unwrap_or_default(),
            false => measure_skill(model, pack, ControllerConfig::default(), id, tries).rate,
        };
        say(format_args!(
            "{} with {which} discriminators: {:.1} % succeed, {:.1} % are recognised, after {:.2} s",
            skill.name,
            100.0 * report.success,
            100.0 * report.recognised,
            report.seconds
        ))?;
    }
    Ok(())
}
