//! The skeleton of a loaded MJCF: derived from it, or given and looked up in it.

use policy_core::glam::Vec3;
use policy_core::training::{Roles, SkeletonBody, SkeletonJoint};
use policy_core::{BodyId, Skeleton};
use rapier3d_mjcf::mjcf_rs::Model as Description;
use rapier3d_mjcf::mjcf_rs::body::{Joint, JointType};
use rapier3d_mjcf::{MjcfDofKind, MjcfRobot};

use crate::model_error::ModelError;

/// How far an axis or a range of a given skeleton may be from the MJCF's, as a number and in radians.
const TOLERANCE: f32 = 1e-3;

/// Where the parts of the skeleton are in the loader's lists.
pub(crate) struct Places {
    /// Of each body: index in `MjcfRobot::bodies`.
    pub bodies: Vec<usize>,
    /// Of each hinge: index in `MjcfRobot::joints`.
    pub joints: Vec<usize>,
}

/// Derives the skeleton. Bodies come in the order of the MJCF, the root first; hinges in the order of their motors.
/// Names tell the roles, in capitals or not: `head`, `hand`, `foot` or `feet`.
pub(crate) fn derive(robot: &MjcfRobot, description: &Description) -> Result<Skeleton, ModelError> {
    let root = root(robot)?;
    let mut ids: Vec<Option<BodyId>> = vec![None; description.bodies.len()];
    let mut bodies = Vec::new();
    let own = robot.bodies.iter().enumerate().skip(root).filter(|(_, body)| !body.is_intermediate);
    for (index, body) in own {
        let parent = description.bodies[body.mjcf_body_id].parent.and_then(|parent| ids[parent]);
        let name = body.name.clone().ok_or(ModelError::Unnamed { kind: "body", index })?;
        if index != root && parent.is_none() {
            return Err(ModelError::Unexpected { kind: "body", name });
        }
        ids[body.mjcf_body_id] = Some(BodyId::new(bodies.len()));
        bodies.push(SkeletonBody { name, parent });
    }
    let mut joints = Vec::new();
    for (index, actuator) in robot.actuators.iter().enumerate() {
        let name = actuator.actuator.joint.clone().ok_or(ModelError::Unnamed { kind: "joint", index })?;
        let (joint, place) = described(robot, description, &name)?;
        let body = robot.bodies[robot.joints[place].link2].mjcf_body_id;
        let body = ids[body].ok_or(ModelError::Missing { kind: "hinge", name: name.clone() })?;
        joints.push(SkeletonJoint { name, body, axis: axis(joint), range: range(joint)? });
    }
    let roles = roles(&bodies);
    Skeleton::from_parts(bodies, joints, roles).map_err(|source| ModelError::Skeleton { source })
}

/// Finds every body and hinge of the skeleton, and refuses an MJCF that differs.
pub(crate) fn places(
    skeleton: &Skeleton,
    robot: &MjcfRobot,
    description: &Description,
) -> Result<Places, ModelError> {
    let place_of = |name: &String| {
        let found = robot.bodies.iter().position(|b| !b.is_intermediate && b.name.as_ref() == Some(name));
        found.ok_or_else(|| ModelError::Missing { kind: "body", name: name.clone() })
    };
    let bodies = skeleton.bodies().iter().map(|b| place_of(&b.name)).collect::<Result<Vec<_>, _>>()?;
    if bodies[0] != root(robot)? {
        return Err(kind("body", &skeleton.bodies()[0].name, "the body that floats", "another body"));
    }
    for (index, body) in robot.bodies.iter().enumerate().skip(1).filter(|(_, b)| !b.is_intermediate) {
        let name = body.name.clone().unwrap_or_default();
        let Some(id) = bodies.iter().position(|&place| place == index) else {
            return Err(ModelError::Unexpected { kind: "body", name });
        };
        let parent = description.bodies[body.mjcf_body_id].parent.filter(|&parent| parent != 0);
        let expected = skeleton.bodies()[id].parent.map(|p| robot.bodies[bodies[p.index()]].mjcf_body_id);
        if parent != expected {
            let name_of = |id: Option<usize>| {
                let body = id.and_then(|id| description.bodies[id].body.name.clone());
                format!("the parent {}", body.unwrap_or_else(|| "world".into()))
            };
            return Err(kind("body", &name, &name_of(expected), &name_of(parent)));
        }
    }
    let mut joints = Vec::with_capacity(skeleton.joint_count());
    for hinge in skeleton.joints() {
        let (joint, place) = described(robot, description, &hinge.name)?;
        check_hinge(hinge, joint)?;
        if robot.joints[place].link2 != bodies[hinge.body.index()]
            && !leads_to(robot, place, bodies[hinge.body.index()])
        {
            return Err(kind(
                "hinge",
                &hinge.name,
                &format!("the body {}", skeleton.body(hinge.body).name),
                "another",
            ));
        }
        joints.push(place);
    }
    // Fixed joints that the loader adds have no name in the MJCF and no freedom.
    let extra =
        robot.joints.iter().enumerate().find(|(index, joint)| {
            !joints.contains(index) && joint.joint.locked_axes.bits().count_ones() < 6
        });
    if let Some((_, joint)) = extra {
        return Err(ModelError::Unexpected { kind: "joint", name: joint.name.clone().unwrap_or_default() });
    }
    Ok(Places { bodies, joints })
}

/// Index in `MjcfRobot::bodies` of the only body that floats.
fn root(robot: &MjcfRobot) -> Result<usize, ModelError> {
    let mut free = robot.qpos_dofs.iter().filter(|dof| dof.kind == MjcfDofKind::Free);
    let (first, others) = (free.next(), free.count());
    match first {
        Some(dof) if others == 0 => Ok(dof.body),
        _ => Err(ModelError::Root { found: others + usize::from(first.is_some()) }),
    }
}

/// True when a joint moves an intermediate link of the chain that ends in `body`.
fn leads_to(robot: &MjcfRobot, joint: usize, body: usize) -> bool {
    let moved = &robot.bodies[robot.joints[joint].link2];
    moved.is_intermediate && moved.mjcf_body_id == robot.bodies[body].mjcf_body_id
}

/// A joint by name: as described in the MJCF, and its index in `MjcfRobot::joints`.
fn described<'a>(
    robot: &MjcfRobot,
    description: &'a Description,
    name: &str,
) -> Result<(&'a Joint, usize), ModelError> {
    let missing = || ModelError::Missing { kind: "hinge", name: name.into() };
    let place = robot.joints.iter().position(|j| j.name.as_deref() == Some(name)).ok_or_else(missing)?;
    let mut all = description.bodies.iter().flat_map(|entry| &entry.body.joints);
    let joint = all.find(|j| j.name.as_deref() == Some(name)).ok_or_else(missing)?;
    if joint.type_ != JointType::Hinge {
        return Err(kind("joint", name, "a hinge", &format!("{:?}", joint.type_)));
    }
    if joint.ref_ != 0.0 {
        return Err(kind("hinge", name, "a ref of 0", &joint.ref_.to_string()));
    }
    Ok((joint, place))
}

fn check_hinge(hinge: &SkeletonJoint, joint: &Joint) -> Result<(), ModelError> {
    let (expected, found) = (hinge.axis.normalize(), axis(joint).normalize_or_zero());
    if (expected - found).length() > TOLERANCE {
        return Err(kind("hinge", &hinge.name, &format!("the axis {expected}"), &found.to_string()));
    }
    let found = range(joint)?;
    if hinge.range.iter().zip(found).any(|(a, b)| (a - b).abs() > TOLERANCE) {
        let expected = format!("the range {:?}", hinge.range);
        return Err(kind("hinge", &hinge.name, &expected, &format!("{found:?}")));
    }
    Ok(())
}

fn axis(joint: &Joint) -> Vec3 {
    Vec3::from_array(joint.axis.map(|v| v as f32))
}

fn range(joint: &Joint) -> Result<[f32; 2], ModelError> {
    let name = joint.name.as_deref().unwrap_or_default();
    let range = joint.range.ok_or_else(|| kind("hinge", name, "a range", "none"))?;
    Ok(range.map(|v| v as f32))
}

fn roles(bodies: &[SkeletonBody]) -> Roles {
    let named = |words: &[&str]| -> Vec<BodyId> {
        let has = |body: &SkeletonBody| {
            let name = body.name.to_ascii_lowercase();
            words.iter().any(|word| name.contains(word))
        };
        (0..bodies.len()).filter(|&i| has(&bodies[i])).map(BodyId::new).collect()
    };
    Roles { head: named(&["head"]).first().copied(), hands: named(&["hand"]), feet: named(&["foot", "feet"]) }
}

pub(crate) fn kind(kind: &'static str, name: &str, expected: &str, found: &str) -> ModelError {
    ModelError::Kind { kind, name: name.into(), expected: expected.into(), found: found.into() }
}
