//! From the names of a manifest to checked parts: what [`CharacterPack::from_parts`](crate::CharacterPack) is made of.

use alloc::string::{String, ToString};
use alloc::vec::Vec;

use crate::action::ActionScaling;
use crate::actuation::ActuationContract;
use crate::excerpt::excerpt;
use crate::features::FRAME_AGES;
use crate::format::{
    DISCRIMINATOR_LAYOUT, EdgeEntry, EndEntry, MAX_NAME_BYTES, Manifest, OBSERVATION_LAYOUT, PACK_FORMAT,
    PACK_VERSION, SkeletonEntry, SkillEntry,
};
use crate::graph::{Edge, GraphError, MAX_NODES, PolicyGraph, check_names};
use crate::ids::{BodyId, DiscriminatorId, NodeId, PolicyId, SkillId};
use crate::mlp::Mlp;
use crate::pack::PackTensors;
use crate::pack_error::PackError;
use crate::skeleton::{MAX_SKELETON_PARTS, Roles, Skeleton, SkeletonBody, SkeletonJoint};
use crate::skill::{EndCondition, Skill};

/// Most skills and most discriminators of a pack.
const MAX_SKILLS: usize = 64;

/// Most skills that act in place of one.
const MAX_IN_STRIDE: usize = 8;

/// Checks the fixed fields, counts and names: all that bounds what the rest may cost.
pub(crate) fn check_manifest(m: &Manifest) -> Result<(), PackError> {
    let field = |field, expected: String, found: String| match expected == found {
        true => Ok(()),
        false => Err(PackError::Field { field, expected, found: excerpt(found) }),
    };
    field("format", PACK_FORMAT.into(), m.format.clone())?;
    field("version", PACK_VERSION.to_string(), m.version.to_string())?;
    field("observation", OBSERVATION_LAYOUT.into(), m.observation.clone())?;
    field("discriminator", DISCRIMINATOR_LAYOUT.into(), m.discriminator.clone())?;
    let counts = [
        ("policies", m.policies.len(), MAX_NODES),
        ("edges", m.edges.len(), MAX_NODES * MAX_NODES),
        ("paths", m.paths.len(), MAX_NODES),
        ("discriminators", m.discriminators.len(), MAX_SKILLS),
        ("skills", m.skills.len(), MAX_SKILLS),
        ("bodies", m.skeleton.bodies.len(), MAX_SKELETON_PARTS),
        ("joints", m.skeleton.joints.len(), MAX_SKELETON_PARTS),
        ("hands", m.skeleton.roles.hands.len(), MAX_SKELETON_PARTS),
        ("feet", m.skeleton.roles.feet.len(), MAX_SKELETON_PARTS),
    ];
    // Of paths and skills that are not too many themselves.
    let paths = m.paths.iter().map(|path| ("policies of a path", path.nodes.len(), MAX_NODES));
    let entries = m.skills.iter().map(|skill| ("entries of a skill", skill.entry.len(), MAX_NODES));
    let in_stride =
        m.skills.iter().map(|skill| ("skills in_stride of one", skill.in_stride.len(), MAX_IN_STRIDE));
    let mut counts = counts.into_iter().chain(paths).chain(entries).chain(in_stride);
    if let Some((what, found, most)) = counts.find(|(_, found, most)| found > most) {
        return Err(PackError::TooMany { what, most, found });
    }
    let names = m.policies.iter().map(|p| ("policy", &p.name));
    let names = names.chain(m.paths.iter().map(|p| ("path", &p.name)));
    let names = names.chain(m.discriminators.iter().map(|d| ("discriminator", &d.name)));
    let names = names.chain(m.skills.iter().map(|s| ("skill", &s.name)));
    let names = names.chain(m.skeleton.bodies.iter().map(|b| ("body", &b.name)));
    let mut names = names.chain(m.skeleton.joints.iter().map(|j| ("joint", &j.name)));
    if let Some((kind, name)) = names.find(|(_, name)| name.len() > MAX_NAME_BYTES) {
        return Err(PackError::LongName { kind, most: MAX_NAME_BYTES, found: name.len() });
    }
    check_names("policy", m.policies.iter().map(|p| p.name.as_str()))?;
    check_names("discriminator", m.discriminators.iter().map(|d| d.name.as_str()))?;
    check_names("skill", m.skills.iter().map(|s| s.name.as_str()))?;
    if !(1.0..=1000.0).contains(&m.control_hz) {
        let (owner, expected) = ("the pack".into(), "1 to 1000");
        return Err(PackError::Number { field: "control_hz", owner, expected, found: m.control_hz });
    }
    Ok(())
}

pub(crate) fn check_networks(m: &Manifest, t: &PackTensors, skeleton: &Skeleton) -> Result<(), PackError> {
    let count = |what, expected, found| match expected == found {
        true => Ok(()),
        false => Err(PackError::Count { what, expected, found }),
    };
    count("policies", m.policies.len(), t.policies.len())?;
    count("discriminators", m.discriminators.len(), t.discriminators.len())?;
    let (observation, frame) = (skeleton.observation_len(), skeleton.frame_len());
    count("means in the observation normaliser", observation, t.observation_normaliser.len())?;
    count("means in the discriminator normaliser", frame, t.discriminator_normaliser.len())?;
    let first = t.policies.first().ok_or(GraphError::NodeCount { found: 0 })?;
    let ends = (skeleton.policy_input_len(), skeleton.joint_count());
    for (entry, mlp) in m.policies.iter().zip(&t.policies) {
        let fits = (mlp.inputs(), mlp.outputs()) == ends;
        if !fits || !mlp.same_shape(first) || widths(mlp) != entry.layers {
            let (same, (inputs, outputs)) = (widths(first), ends);
            let expected = alloc::format!(
                "{inputs} .. {outputs}, as the manifest says and as the first policy, {same:?}"
            );
            return Err(PackError::Layers { name: entry.name.clone(), expected, found: widths(mlp) });
        }
    }
    let inputs = frame * FRAME_AGES.len();
    for (entry, mlp) in m.discriminators.iter().zip(&t.discriminators) {
        if mlp.inputs() != inputs || mlp.outputs() != 1 || widths(mlp) != entry.layers {
            let expected = alloc::format!("{inputs} .. 1, as the manifest says");
            return Err(PackError::Layers { name: entry.name.clone(), expected, found: widths(mlp) });
        }
    }
    Ok(())
}

/// Every skill must be reachable from every node that a path runs through.
pub(crate) fn check_reachable(graph: &PolicyGraph, skills: &[Skill]) -> Result<(), PackError> {
    let mut seen = [false; MAX_NODES];
    let is_new = |node: &NodeId| !core::mem::replace(&mut seen[node.index()], true);
    let on_paths = graph.paths().iter().flat_map(|path| path.nodes().iter().copied());
    let on_paths: Vec<NodeId> = on_paths.filter(is_new).collect();
    for skill in skills.iter().filter(|s| !s.entry.is_empty()) {
        let reaches =
            |from: &&NodeId| skill.entry.iter().any(|to| graph.routes().cost(**from, *to).is_finite());
        if let Some(from) = on_paths.iter().find(|from| !reaches(from)) {
            let from = graph.node(*from).name.clone();
            return Err(PackError::Unreachable { skill: skill.name.clone(), from });
        }
    }
    Ok(())
}

pub(crate) fn skeleton(entry: &SkeletonEntry) -> Result<Skeleton, PackError> {
    let names = || entry.bodies.iter().map(|b| b.name.as_str());
    let body =
        |field: &str, name: &str| Ok::<_, PackError>(BodyId::new(find("body", field, name, &mut names())?));
    let bodies = entry.bodies.iter().map(|b| {
        let parent = match &b.parent {
            None => None,
            Some(parent) => Some(body("parent", parent)?),
        };
        Ok(SkeletonBody { name: b.name.clone(), parent })
    });
    let joints = entry.joints.iter().map(|j| {
        let (name, axis) = (j.name.clone(), glam::Vec3::from(j.axis));
        Ok(SkeletonJoint { name, body: body("joints", &j.body)?, axis, range: j.range })
    });
    let all = |names: &[String]| names.iter().map(|n| body("roles", n)).collect::<Result<Vec<_>, _>>();
    let head = match &entry.roles.head {
        None => None,
        Some(name) => Some(body("roles", name)?),
    };
    let roles = Roles { head, hands: all(&entry.roles.hands)?, feet: all(&entry.roles.feet)? };
    let (bodies, joints) =
        (bodies.collect::<Result<_, PackError>>()?, joints.collect::<Result<_, PackError>>()?);
    Ok(Skeleton::from_parts(bodies, joints, roles)?)
}

pub(crate) fn action_scaling(m: &Manifest, skeleton: &Skeleton) -> Result<ActionScaling, PackError> {
    let expected = skeleton.joint_count();
    let motors = m.actuation.as_ref().map_or(expected, |a| a.joints.len());
    let counts = [
        ("action_centre", m.action_centre.len()),
        ("action_gain", m.action_gain.len()),
        ("actuation.joints", motors),
    ];
    if let Some(&(what, found)) = counts.iter().find(|(_, found)| *found != expected) {
        return Err(PackError::Count { what, expected, found });
    }
    if let Some((field, found)) = m.actuation.as_ref().and_then(ActuationContract::bad_number) {
        let (owner, expected) = ("actuation".into(), "a finite number of at least 0");
        return Err(PackError::Number { field, owner, expected, found });
    }
    Ok(ActionScaling::from_centre_and_gain(&m.action_centre, &m.action_gain)?)
}

/// Inputs of the first layer, then the outputs of each.
pub(crate) fn widths(mlp: &Mlp) -> Vec<usize> {
    core::iter::once(mlp.inputs()).chain(mlp.layers().iter().map(|l| l.outputs())).collect()
}

pub(crate) fn find(
    kind: &'static str,
    field: impl ToString,
    name: &str,
    names: &mut dyn Iterator<Item = &str>,
) -> Result<usize, PackError> {
    let unknown = || PackError::UnknownName { kind, field: field.to_string(), found: excerpt(name) };
    Iterator::position(&mut &mut *names, |n| n == name).ok_or_else(unknown)
}

pub(crate) fn find_node(field: String, name: &str, names: &[&str]) -> Result<NodeId, PackError> {
    Ok(NodeId::new(find("policy", field, name, &mut names.iter().copied())?))
}

pub(crate) fn edge(entry: &EdgeEntry, names: &[&str]) -> Result<Edge, PackError> {
    let end = |i: usize| find_node("edges".into(), &entry.nodes[i], names);
    let seconds = [entry.seconds, entry.seconds_back.unwrap_or(entry.seconds)];
    Ok(Edge { transit: entry.transit, ..Edge::new([end(0)?, end(1)?], seconds) })
}

pub(crate) fn skill(entry: &SkillEntry, names: &[&str], m: &Manifest) -> Result<Skill, PackError> {
    let field = || alloc::format!("skill \"{}\"", entry.name);
    let mut discriminators = m.discriminators.iter().map(|d| d.name.as_str());
    Ok(Skill {
        name: entry.name.clone(),
        policy: PolicyId::from(find_node(field(), &entry.policy, names)?),
        entry: entry.entry.iter().map(|n| find_node(field(), n, names)).collect::<Result<_, _>>()?,
        minimum_speed_mps: minimum_speed(entry, field())?,
        maximum_speed_mps: maximum_speed(entry, field())?,
        on_footfall: entry.on_footfall,
        in_stride: in_stride(entry, m)?,
        clock_seconds: clock_seconds(entry, field())?,
        returns_to: find_node(field(), &entry.returns_to, names)?,
        discriminator: match &entry.discriminator {
            None => None,
            Some(name) => {
                Some(DiscriminatorId::new(find("discriminator", field(), name, &mut discriminators)?))
            }
        },
        end: end_condition(&entry.end, field())?,
    })
}

fn minimum_speed(entry: &SkillEntry, owner: String) -> Result<f32, PackError> {
    let found = entry.minimum_speed_mps;
    let (field, expected) = ("minimum_speed_mps", "0 to 20");
    if (0.0..=20.0).contains(&found) {
        Ok(found)
    } else {
        Err(PackError::Number { field, owner, expected, found })
    }
}

fn maximum_speed(entry: &SkillEntry, owner: String) -> Result<f32, PackError> {
    let Some(found) = entry.maximum_speed_mps else { return Ok(f32::INFINITY) };
    let (field, expected) = ("maximum_speed_mps", "above minimum_speed_mps, up to 20");
    if found > entry.minimum_speed_mps && found <= 20.0 {
        Ok(found)
    } else {
        Err(PackError::Number { field, owner, expected, found })
    }
}

/// What acts in place of a skill in the stride of a gait: skills that need a speed, and in whose place nothing else acts.
fn in_stride(entry: &SkillEntry, m: &Manifest) -> Result<Vec<SkillId>, PackError> {
    let one = |name: &String| {
        let field = alloc::format!("in_stride of skill \"{}\"", entry.name);
        let id = SkillId::new(find("skill", field, name, &mut m.skills.iter().map(|s| s.name.as_str()))?);
        let other = &m.skills[id.index()];
        if other.minimum_speed_mps > 0.0 && other.in_stride.is_empty() {
            return Ok(id);
        }
        Err(PackError::InStride { skill: entry.name.clone(), found: name.clone() })
    };
    entry.in_stride.iter().map(one).collect()
}

fn clock_seconds(entry: &SkillEntry, owner: String) -> Result<Option<f32>, PackError> {
    let (field, expected) = ("clock_seconds", "above 0, up to 600");
    match entry.clock_seconds {
        Some(found) if !(f32::MIN_POSITIVE..=600.0).contains(&found) => {
            Err(PackError::Number { field, owner, expected, found })
        }
        clock => Ok(clock),
    }
}

fn end_condition(end: &EndEntry, owner: String) -> Result<EndCondition, PackError> {
    let checks = [
        ("threshold", end.threshold, 1.0, "0 to 1"),
        ("hysteresis", end.hysteresis, end.threshold, "0 to the threshold"),
        ("hold_seconds", end.hold_seconds, end.limit_seconds, "above 0, up to the limit"),
        ("minimum_seconds", end.minimum_seconds, end.limit_seconds, "0 to the limit"),
        ("limit_seconds", end.limit_seconds, 600.0, "0 to 600"),
        ("minimum_height", end.minimum_height, 10.0, "0 to 10"),
    ];
    for (field, found, most, expected) in checks {
        let least = if field == "hold_seconds" { f32::MIN_POSITIVE } else { 0.0 };
        if !(least..=most).contains(&found) {
            return Err(PackError::Number { field, owner, expected, found });
        }
    }
    Ok(EndCondition {
        threshold: end.threshold,
        hysteresis: end.hysteresis,
        hold_seconds: end.hold_seconds,
        minimum_seconds: end.minimum_seconds,
        limit_seconds: end.limit_seconds,
        minimum_height: end.minimum_height,
    })
}
