//! The skeleton of a compiled MJCF: the bodies below the one that floats, in the order of the MJCF, and the
//! hinges in the order of their motors. Roles follow from the names of the bodies.

use std::sync::Arc;

use glam::DVec3;
use mujoco_rs::wrappers::mj_model::{MjModel, MjtJoint, MjtObjBase, MjtTrn};
use policy_core::training::{Roles, SkeletonBody, SkeletonJoint};
use policy_core::{BodyId, Skeleton};

use super::file::quoted;
use super::model_error::ModelError;

/// How far an axis or a range of a given skeleton may be from the MJCF's, as a number and in radians.
const TOLERANCE: f32 = 1e-3;

/// MuJoCo's id of the only body that floats.
pub(super) fn root(model: &MjModel) -> Result<usize, ModelError> {
    let floating: Vec<usize> = (0..model.njnt() as usize)
        .filter(|&joint| model.jnt_type()[joint] == MjtJoint::mjJNT_FREE)
        .map(|joint| model.jnt_bodyid()[joint] as usize)
        .collect();
    match floating[..] {
        [root] => Ok(root),
        _ => Err(ModelError::Root { found: floating.len() }),
    }
}

/// Derives the skeleton.
pub(super) fn derive(model: &MjModel) -> Result<Skeleton, ModelError> {
    let root = root(model)?;
    // Parents come before their children, so one pass finds everything below the root.
    let mut ids: Vec<Option<BodyId>> = vec![None; model.nbody() as usize];
    let mut bodies = Vec::new();
    for body in root..model.nbody() as usize {
        // MuJoCo has compiled the model: what it says of its parts are indices of its own arrays.
        let parent = ids[model.body_parentid()[body] as usize];
        if body != root && parent.is_none() {
            continue;
        }
        ids[body] = Some(BodyId::new(bodies.len()));
        let name = name(model, MjtObjBase::mjOBJ_BODY, "body", body)?;
        bodies.push(SkeletonBody { name, parent: if body == root { None } else { parent } });
    }
    let joints = (0..model.nactuator() as usize).map(|actuator| joint(model, actuator, &ids));
    let joints = joints.collect::<Result<Vec<_>, _>>()?;
    let roles = roles(&bodies);
    Skeleton::from_parts(bodies, joints, roles).map_err(|error| ModelError::Skeleton { error })
}

/// Checks that `given` says of its bodies and hinges what the MJCF says of those of the same names.
pub(super) fn check(given: &Arc<Skeleton>, model: &MjModel) -> Result<(), ModelError> {
    let found = derive(model)?;
    let counts = [("bodies", given.body_count(), found.body_count())];
    for (what, expected, found) in
        counts.into_iter().chain([("hinges with a motor", given.joint_count(), found.joint_count())])
    {
        if expected != found {
            return Err(ModelError::Count { what, expected, found });
        }
    }
    let parent_name = |skeleton: &Skeleton, body: BodyId| {
        skeleton.parent(body).map(|parent| skeleton.body(parent).name.clone())
    };
    for (index, SkeletonBody { name, .. }) in given.bodies().iter().enumerate() {
        let missing = || ModelError::Missing { kind: "body", name: quoted(name) };
        let body = found.body_named(name).ok_or_else(missing)?;
        if parent_name(given, BodyId::new(index)) != parent_name(&found, body) {
            return Err(ModelError::Kind {
                kind: "body",
                name: quoted(name),
                expected: "the parent of the skeleton",
            });
        }
    }
    for joint in given.joints() {
        let missing = || ModelError::Missing { kind: "joint", name: quoted(&joint.name) };
        let other = &found.joints()[found.joint_named(&joint.name).ok_or_else(missing)?.index()];
        let close = |a: f32, b: f32| (a - b).abs() <= TOLERANCE;
        let fits = given.body(joint.body).name == found.body(other.body).name
            && joint.axis.normalize().distance(other.axis.normalize()) <= TOLERANCE
            && close(joint.range[0], other.range[0])
            && close(joint.range[1], other.range[1]);
        if !fits {
            let expected = "the body, axis and range of the skeleton";
            return Err(ModelError::Kind { kind: "joint", name: quoted(&joint.name), expected });
        }
    }
    Ok(())
}

/// The hinge that a motor drives.
fn joint(model: &MjModel, actuator: usize, ids: &[Option<BodyId>]) -> Result<SkeletonJoint, ModelError> {
    let kind = |expected| {
        let name = model.id_to_name(MjtObjBase::mjOBJ_ACTUATOR, actuator);
        let name = name.map_or_else(|| format!("number {actuator}"), quoted);
        ModelError::Kind { kind: "actuator", name, expected }
    };
    if model.actuator_trntype()[actuator] != MjtTrn::mjTRN_JOINT {
        return Err(kind("a joint to drive"));
    }
    let joint = model.actuator_trnid()[actuator][0] as usize;
    let body =
        ids[model.jnt_bodyid()[joint] as usize].ok_or_else(|| kind("a joint of the body that floats"))?;
    let name = name(model, MjtObjBase::mjOBJ_JOINT, "joint", joint)?;
    let expect = |fits: bool, expected| {
        let name = quoted(&name);
        if fits { Ok(()) } else { Err(ModelError::Kind { kind: "joint", name, expected }) }
    };
    expect(model.jnt_type()[joint] == MjtJoint::mjJNT_HINGE, "a hinge")?;
    expect(model.jnt_limited()[joint], "a limited range")?;
    let axis = DVec3::from(model.jnt_axis()[joint]).as_vec3();
    let range = model.jnt_range()[joint].map(|angle| angle as f32);
    Ok(SkeletonJoint { name, body, axis, range })
}

/// Roles by convention: the first body with `head` in its name, all with `hand`, all with `foot` or `feet`.
fn roles(bodies: &[SkeletonBody]) -> Roles {
    let named = |parts: &'static [&'static str]| {
        let fits = move |name: &str| parts.iter().any(|part| name.contains(part));
        let bodies = bodies.iter().enumerate().filter(move |(_, body)| fits(&body.name.to_ascii_lowercase()));
        bodies.map(|(index, _)| BodyId::new(index))
    };
    Roles {
        head: named(&["head"]).next(),
        hands: named(&["hand"]).collect(),
        feet: named(&["foot", "feet"]).collect(),
    }
}

fn name(model: &MjModel, object: MjtObjBase, kind: &'static str, id: usize) -> Result<String, ModelError> {
    let name = model.id_to_name(object, id).filter(|name| !name.is_empty());
    name.map(str::to_owned).ok_or(ModelError::Unnamed { kind, index: id })
}

#[cfg(test)]
mod tests {
    use super::super::model::Model;
    use super::*;

    #[test]
    fn the_humanoids_mjcf_has_the_skeleton_of_version_one_packs() {
        let model = Model::from_mjcf(include_str!("../../../../assets/humanoid.xml")).unwrap();
        let (found, expected) = (model.skeleton(), Skeleton::humanoid());
        assert_eq!(found.bodies(), expected.bodies());
        assert_eq!(found.roles(), expected.roles());
        assert_eq!(found.joint_count(), expected.joint_count());
        for (found, expected) in found.joints().iter().zip(expected.joints()) {
            assert_eq!((&found.name, found.body), (&expected.name, expected.body));
            assert!(found.axis.distance(expected.axis) < 1e-6);
            assert!((0..2).all(|i| (found.range[i] - expected.range[i]).abs() < 1e-6), "{found:?}");
        }
    }
}
