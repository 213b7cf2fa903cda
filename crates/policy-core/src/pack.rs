//! The character pack: everything a character needs at run time but its body, checked and immutable.

use alloc::string::{String, ToString};
use alloc::vec::Vec;

use crate::action::ActionScaling;
use crate::body::{BODY_NAMES, DOF_COUNT, JOINT_NAMES};
use crate::features::{DISCRIMINATOR_INPUT_LEN, FRAME_LEN};
use crate::graph::{GraphError, Node, Path, PolicyGraph, check_names};
use crate::manifest::{
    DISCRIMINATOR_LAYOUT, EdgeEntry, Manifest, OBSERVATION_LAYOUT, PACK_FORMAT, PACK_VERSION, PathEntry,
    SkillEntry,
};
use crate::mlp::Mlp;
use crate::normaliser::Normaliser;
use crate::observation::{OBSERVATION_LEN, POLICY_INPUT_LEN};
use crate::pack_error::PackError;
use crate::skill::{EndCondition, Skill};

/// The numbers of a pack; the manifest says what they are.
#[derive(Clone, Debug, PartialEq)]
pub struct PackTensors {
    /// One network for each policy of the manifest, all of one shape: 225 inputs, 28 outputs.
    pub policies: Vec<Mlp>,
    /// One network for each discriminator of the manifest: 625 inputs, 1 output (a logit).
    pub discriminators: Vec<Mlp>,
    /// Of the 223 observations.
    pub observation_normaliser: Normaliser,
    /// Of the 125 features of a frame.
    pub discriminator_normaliser: Normaliser,
}

/// Every policy, discriminator and skill of one character, and the graph that joins them.
///
/// Immutable: share one pack between all characters (`Arc`). [`CharacterPack::from_bytes`] reads one.
#[derive(Clone, Debug)]
pub struct CharacterPack {
    manifest: Manifest,
    tensors: PackTensors,
    graph: PolicyGraph,
    skills: Vec<Skill>,
    recovery: Option<usize>,
    action: ActionScaling,
}

impl CharacterPack {
    /// A pack of a manifest and its tensors.
    ///
    /// # Errors
    /// When anything is not as the manifest or this library says; see [`PackError`].
    pub fn from_parts(manifest: Manifest, tensors: PackTensors) -> Result<Self, PackError> {
        check_fixed_fields(&manifest)?;
        check_networks(&manifest, &tensors)?;
        let nodes: Vec<Node> = manifest
            .policies
            .iter()
            .map(|p| Node { name: p.name.clone(), fall_height: p.fall_height, speed_mps: p.speed_mps })
            .collect();
        let names: Vec<&str> = nodes.iter().map(|n| n.name.as_str()).collect();
        check_names("policy", names.iter().copied())?;
        check_names("skill", manifest.skills.iter().map(|s| s.name.as_str()))?;
        let edges = manifest.edges.iter().map(|e| edge(e, &names)).collect::<Result<Vec<_>, _>>()?;
        let paths = manifest.paths.iter().map(|p| path(p, &names)).collect::<Result<Vec<_>, _>>()?;
        let skills =
            manifest.skills.iter().map(|s| skill(s, &names, &manifest)).collect::<Result<Vec<_>, _>>()?;
        let recovery = match &manifest.recovery {
            None => None,
            Some(name) => {
                Some(find("skill", "recovery", name, manifest.skills.iter().map(|s| s.name.as_str()))?)
            }
        };
        let action = ActionScaling::from_centre_and_gain(
            joint_numbers("action_centre", &manifest.action_centre)?,
            joint_numbers("action_gain", &manifest.action_gain)?,
        )?;
        let graph = PolicyGraph::from_parts(nodes, &edges, paths, &tensors.policies)?;
        Ok(Self { manifest, tensors, graph, skills, recovery, action })
    }

    /// The description the pack was made of.
    #[must_use]
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// All numbers of the pack.
    #[must_use]
    pub fn tensors(&self) -> &PackTensors {
        &self.tensors
    }

    /// Policies, one for each node of the graph.
    #[must_use]
    pub fn policies(&self) -> &[Mlp] {
        &self.tensors.policies
    }

    /// The policy graph.
    #[must_use]
    pub fn graph(&self) -> &PolicyGraph {
        &self.graph
    }

    /// Episodic skills.
    #[must_use]
    pub fn skills(&self) -> &[Skill] {
        &self.skills
    }

    /// Index of the skill called `name`.
    #[must_use]
    pub fn skill_named(&self, name: &str) -> Option<usize> {
        self.skills.iter().position(|s| s.name == name)
    }

    /// Index of the skill that brings a fallen character to its feet.
    #[must_use]
    pub fn recovery(&self) -> Option<usize> {
        self.recovery
    }

    /// How actions become joint targets.
    #[must_use]
    pub fn action(&self) -> &ActionScaling {
        &self.action
    }
}

fn check_fixed_fields(m: &Manifest) -> Result<(), PackError> {
    let field = |field, expected: String, found: String| match expected == found {
        true => Ok(()),
        false => Err(PackError::Field { field, expected, found }),
    };
    field("format", PACK_FORMAT.into(), m.format.clone())?;
    field("version", PACK_VERSION.to_string(), m.version.to_string())?;
    field("observation", OBSERVATION_LAYOUT.into(), m.observation.clone())?;
    field("discriminator", DISCRIMINATOR_LAYOUT.into(), m.discriminator.clone())?;
    field("bodies", BODY_NAMES.join(" "), m.bodies.join(" "))?;
    field("joints", JOINT_NAMES.join(" "), m.joints.join(" "))?;
    if m.control_hz.is_finite() && (1.0..=1000.0).contains(&m.control_hz) {
        return Ok(());
    }
    let (owner, expected) = ("the pack".into(), "1 to 1000");
    Err(PackError::Number { field: "control_hz", owner, expected, found: m.control_hz })
}

fn check_networks(m: &Manifest, t: &PackTensors) -> Result<(), PackError> {
    let count = |what, expected, found| match expected == found {
        true => Ok(()),
        false => Err(PackError::Count { what, expected, found }),
    };
    count("policies", m.policies.len(), t.policies.len())?;
    count("discriminators", m.discriminators.len(), t.discriminators.len())?;
    count("means in the observation normaliser", OBSERVATION_LEN, t.observation_normaliser.len())?;
    count("means in the discriminator normaliser", FRAME_LEN, t.discriminator_normaliser.len())?;
    check_names("discriminator", m.discriminators.iter().map(|d| d.name.as_str()))?;
    let first = t.policies.first().ok_or(GraphError::NodeCount { found: 0 })?;
    for (entry, mlp) in m.policies.iter().zip(&t.policies) {
        let ends = mlp.inputs() == POLICY_INPUT_LEN && mlp.outputs() == DOF_COUNT;
        if !ends || !mlp.same_shape(first) || widths(mlp) != entry.layers {
            let same = widths(first);
            let expected = alloc::format!(
                "{POLICY_INPUT_LEN} .. {DOF_COUNT}, as the manifest says and as the first policy, {same:?}"
            );
            return Err(PackError::Layers { name: entry.name.clone(), expected, found: widths(mlp) });
        }
    }
    for (entry, mlp) in m.discriminators.iter().zip(&t.discriminators) {
        if mlp.inputs() != DISCRIMINATOR_INPUT_LEN || mlp.outputs() != 1 || widths(mlp) != entry.layers {
            let expected = alloc::format!("{DISCRIMINATOR_INPUT_LEN} .. 1, as the manifest says");
            return Err(PackError::Layers { name: entry.name.clone(), expected, found: widths(mlp) });
        }
    }
    Ok(())
}

/// Inputs of the first layer, then the outputs of each.
pub(crate) fn widths(mlp: &Mlp) -> Vec<usize> {
    core::iter::once(mlp.inputs()).chain(mlp.layers().iter().map(|l| l.outputs())).collect()
}

fn find<'a>(
    kind: &'static str,
    field: impl ToString,
    name: &str,
    mut names: impl Iterator<Item = &'a str>,
) -> Result<usize, PackError> {
    let unknown = || PackError::UnknownName { kind, field: field.to_string(), found: name.into() };
    names.position(|n| n == name).ok_or_else(unknown)
}

fn find_policy(field: String, name: &str, names: &[&str]) -> Result<usize, PackError> {
    find("policy", field, name, names.iter().copied())
}

fn edge(entry: &EdgeEntry, names: &[&str]) -> Result<([usize; 2], f32), PackError> {
    let end = |i: usize| find_policy("edges".into(), &entry.nodes[i], names);
    Ok(([end(0)?, end(1)?], entry.seconds))
}

fn path(entry: &PathEntry, names: &[&str]) -> Result<Path, PackError> {
    let field = || alloc::format!("path \"{}\"", entry.name);
    let nodes = entry.nodes.iter().map(|n| find_policy(field(), n, names)).collect::<Result<_, _>>()?;
    Ok(Path { name: entry.name.clone(), nodes })
}

fn skill(entry: &SkillEntry, names: &[&str], m: &Manifest) -> Result<Skill, PackError> {
    let field = || alloc::format!("skill \"{}\"", entry.name);
    check_end(&entry.end, field())?;
    let discriminators = m.discriminators.iter().map(|d| d.name.as_str());
    Ok(Skill {
        name: entry.name.clone(),
        policy: find_policy(field(), &entry.policy, names)?,
        entry: entry.entry.iter().map(|n| find_policy(field(), n, names)).collect::<Result<_, _>>()?,
        returns_to: find_policy(field(), &entry.returns_to, names)?,
        discriminator: match &entry.discriminator {
            None => None,
            Some(name) => Some(find("discriminator", field(), name, discriminators)?),
        },
        end: entry.end,
    })
}

fn check_end(end: &EndCondition, owner: String) -> Result<(), PackError> {
    let checks = [
        ("threshold", end.threshold, 1.0, "0 to 1"),
        ("hysteresis", end.hysteresis, end.threshold, "0 to the threshold"),
        ("minimum_seconds", end.minimum_seconds, end.limit_seconds, "0 to the limit"),
        ("limit_seconds", end.limit_seconds, 600.0, "0 to 600"),
        ("ticks", end.ticks as f32, 1e4, "1 to 10000"),
        ("minimum_height", end.minimum_height, 10.0, "0 to 10"),
    ];
    for (field, found, most, expected) in checks {
        let least = if field == "ticks" { 1.0 } else { 0.0 };
        if !(least..=most).contains(&found) {
            return Err(PackError::Number { field, owner, expected, found });
        }
    }
    Ok(())
}

fn joint_numbers(what: &'static str, numbers: &[f32]) -> Result<[f32; DOF_COUNT], PackError> {
    numbers.try_into().map_err(|_| PackError::Count { what, expected: DOF_COUNT, found: numbers.len() })
}
