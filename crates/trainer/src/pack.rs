//! Binding trained skills into a character pack, through policy-core's own checks and writer.

use std::path::{Path, PathBuf};

use physics_bridge::Model;
use policy_core::format::{
    DISCRIMINATOR_LAYOUT, DiscriminatorEntry, Manifest, OBSERVATION_LAYOUT, PACK_FORMAT, PACK_VERSION,
    PolicyEntry, SkeletonEntry, Storage,
};
use policy_core::training::{ActionScaling, Layer, MlpError, PackTensors};
use policy_core::{CharacterPack, Mlp, PackError};

mod distil;
mod plan;
mod rollouts;
mod source;

pub use distil::{Agreement, DISTILLED_HIDDEN, distil};
pub use plan::{PackPlan, PlannedPolicy};
pub use source::trained_policy;

use crate::checkpoint::{ACTOR, Checkpoint, CheckpointError, DISCRIMINATOR, EMA};
use crate::env::Normalisers;
use crate::nn::Network;
use crate::toml_file::TomlFileError;

/// Why a pack can't be bound.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BindError {
    /// The plan can't be read, or its fields are not those expected.
    #[error(transparent)]
    Plan(#[from] TomlFileError),
    /// A checkpoint is missing or wrong.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// A network is none that a pack can hold.
    #[error("{role} of {skill}")]
    Network {
        /// Name of the skill.
        skill: String,
        /// Policy or discriminator.
        role: &'static str,
        /// What is wrong with it.
        source: MlpError,
    },
    /// A pack has no policy of a name.
    #[error("expected a policy of the pack, one of {known}, found {name}")]
    Unknown {
        /// The name.
        name: String,
        /// The names that it has.
        known: String,
    },
    /// The parts don't fit together.
    #[error(transparent)]
    Pack(#[from] PackError),
}

/// Where a skill comes from and its networks.
#[derive(Clone, Debug)]
pub struct TrainedSkill {
    /// Name of the skill.
    pub skill: String,
    /// Its policy.
    pub actor: Network,
    /// Its discriminator.
    pub discriminator: Network,
    /// Recipe, samples and seed in words.
    pub origin: String,
}

impl TrainedSkill {
    /// The skill out of a checkpoint of its own run, or of one that trained it together with others; `path` is named in
    /// errors.
    ///
    /// # Errors
    /// When the checkpoint lacks a network.
    pub fn from_checkpoint(skill: &str, loaded: &Checkpoint, path: &Path) -> Result<Self, CheckpointError> {
        let together = Self::is_in(skill, loaded);
        let role = |what: &str| if together { format!("{skill}.{what}") } else { what.to_owned() };
        let progress = &loaded.progress;
        let recipe = if together { "joint recipe" } else { "recipe" };
        Ok(Self {
            skill: skill.into(),
            // The moving average where there is one: old checkpoints have the policy alone.
            actor: match loaded.networks.get(&role(EMA)) {
                Some(ema) => ema.network.clone(),
                None => loaded.network(&role(ACTOR), path)?.network.clone(),
            },
            discriminator: loaded.network(&role(DISCRIMINATOR), path)?.network.clone(),
            origin: format!(
                "{recipe} {skill}, seed {}, {} samples, {:.0} s",
                progress.seed, progress.samples, progress.secs
            ),
        })
    }

    /// The skill of a run.
    ///
    /// # Errors
    /// When its checkpoint is missing or wrong.
    pub fn load(skill: &str, checkpoint: &Path) -> Result<Self, CheckpointError> {
        Self::from_checkpoint(skill, &Checkpoint::load(checkpoint)?, checkpoint)
    }

    /// True when a checkpoint is of a run that trained this skill together with others.
    #[must_use]
    pub fn is_in(skill: &str, checkpoint: &Checkpoint) -> bool {
        checkpoint.networks.contains_key(&format!("{skill}.{ACTOR}"))
    }
}

/// Binds the skills of `plan` into a pack, with the body of `model` and, if there is one, a binary glTF mesh.
///
/// # Errors
/// When a skill of the plan is not trained, or policy-core refuses the parts.
pub fn bind(
    plan: &PackPlan,
    trained: &[TrainedSkill],
    normalisers: &Normalisers,
    model: &Model,
    mesh: Option<Vec<u8>>,
) -> Result<CharacterPack, BindError> {
    let skeleton = model.skeleton();
    let scaling = ActionScaling::from_skeleton(skeleton);
    let (policies, entries) = policies(plan, trained)?;
    let (discriminators, discriminator_entries) = discriminators(plan, trained)?;
    let manifest = Manifest {
        format: PACK_FORMAT.into(),
        version: PACK_VERSION,
        character: plan.character.clone(),
        control_hz: model.control_hz(),
        observation: OBSERVATION_LAYOUT.into(),
        discriminator: DISCRIMINATOR_LAYOUT.into(),
        skeleton: SkeletonEntry::from(skeleton.as_ref()),
        actuation: Some(model.actuation()),
        credits: plan.credits.clone(),
        mjcf: Some(model.mjcf().to_owned()),
        checksum: None,
        action_centre: scaling.centre().to_vec(),
        action_gain: scaling.gain().to_vec(),
        policies: entries,
        edges: plan.edges.clone(),
        paths: plan.paths.clone(),
        discriminators: discriminator_entries,
        skills: plan.skills.clone(),
        recovery: plan.recovery.clone(),
    };
    let tensors = PackTensors {
        policies,
        discriminators,
        observation_normaliser: normalisers.observation.clone(),
        discriminator_normaliser: normalisers.frame.clone(),
        mesh,
    };
    Ok(CharacterPack::from_parts(manifest, tensors)?)
}

/// The pack with another policy in place of the one of the same name.
///
/// # Errors
/// When the pack has no policy of that name, or the new one does not fit.
pub fn with_policy(pack: &CharacterPack, trained: &TrainedSkill) -> Result<CharacterPack, BindError> {
    let (mut manifest, mut tensors) = (pack.manifest().clone(), pack.tensors().clone());
    let name = &trained.skill;
    let Some(id) = pack.policy_named(name) else {
        let names: Vec<&str> = manifest.policies.iter().map(|policy| policy.name.as_str()).collect();
        return Err(BindError::Unknown { name: name.clone(), known: names.join(", ") });
    };
    tensors.policies[id.index()] = mlp(&trained.actor, name, "policy")?;
    let entry = &mut manifest.policies[id.index()];
    (entry.layers, entry.origin) = (trained.actor.sizes().to_vec(), trained.origin.clone());
    Ok(CharacterPack::from_parts(manifest, tensors)?)
}

/// The trained skill of this name.
fn find<'a>(trained: &'a [TrainedSkill], name: &str) -> Result<&'a TrainedSkill, CheckpointError> {
    trained.iter().find(|skill| skill.skill == name).ok_or_else(|| CheckpointError::Content {
        path: PathBuf::from(name),
        expected: "a trained skill of this name".into(),
        found: "none".into(),
    })
}

/// The policies of a plan.
fn policies(plan: &PackPlan, trained: &[TrainedSkill]) -> Result<(Vec<Mlp>, Vec<PolicyEntry>), BindError> {
    let mut all = (Vec::new(), Vec::new());
    for planned in &plan.policies {
        let skill = find(trained, &planned.name)?;
        all.0.push(mlp(&skill.actor, &planned.name, "policy")?);
        all.1.push(PolicyEntry {
            name: planned.name.clone(),
            layers: skill.actor.sizes().to_vec(),
            fall_height: planned.fall_height,
            speed_mps: planned.speed_mps,
            strafes: planned.strafes,
            rough_ground: planned.rough_ground.clone(),
            agile: planned.agile.clone(),
            steady: planned.steady.clone(),
            resting: planned.resting.clone(),
            starting: planned.starting.clone(),
            stopping: planned.stopping.clone(),
            turning: planned.turning.clone(),
            catching: planned.catching.clone(),
            rising: planned.rising.clone(),
            origin: skill.origin.clone(),
        });
    }
    Ok(all)
}

/// The discriminators that end a plan's skills, each once.
fn discriminators(
    plan: &PackPlan,
    trained: &[TrainedSkill],
) -> Result<(Vec<Mlp>, Vec<DiscriminatorEntry>), BindError> {
    let mut names: Vec<&str> = plan.skills.iter().filter_map(|s| s.discriminator.as_deref()).collect();
    names.sort_unstable();
    names.dedup();
    let mut all = (Vec::new(), Vec::new());
    for name in names {
        let network = &find(trained, name)?.discriminator;
        all.0.push(mlp(network, name, "discriminator")?);
        let layers = network.sizes().to_vec();
        all.1.push(DiscriminatorEntry { name: name.into(), layers, storage: Storage::F16 });
    }
    Ok(all)
}

/// A network as policy-core evaluates it.
fn mlp(network: &Network, skill: &str, role: &'static str) -> Result<Mlp, BindError> {
    let wrong = |source| BindError::Network { skill: skill.into(), role, source };
    let layer = |range: crate::nn::LayerRange| {
        // A checkpoint is refused whose parameters are not as many as the sizes say.
        let (weight, bias) = (&network.parameters[range.weight], &network.parameters[range.bias]);
        Layer::from_input_major(range.inputs, range.outputs, weight, bias)
    };
    let layers = network.layers().into_iter().map(layer).collect::<Result<Vec<_>, _>>().map_err(wrong)?;
    Mlp::from_layers(layers).map_err(wrong)
}
