//! What a loaded MJCF says of motors, rate and standing pose, checked.

use policy_core::contract::{Pose, PoseError, ROOT_QPOS};
use policy_core::training::SkeletonJoint;
use policy_core::{JointActuation, Skeleton};
use rapier3d::dynamics::JointAxesMask;
use rapier3d_mjcf::MjcfRobot;
use rapier3d_mjcf::mjcf_rs::extras::ActuatorKind;

use crate::model_error::ModelError;
use crate::skeleton::{Places, kind};

/// Name of the keyframe in which a character stands.
const STAND: &str = "stand";

/// Gain, damping, force limit and armature of each hinge.
pub(super) fn motors(
    robot: &MjcfRobot,
    skeleton: &Skeleton,
    places: &Places,
) -> Result<Vec<JointActuation>, ModelError> {
    const WHAT: &str = "motor of hinge";
    let motor = |(hinge, &place): (&SkeletonJoint, &usize)| {
        let name = &hinge.name;
        let mut own = robot.actuators.iter().filter(|a| a.actuator.joint.as_ref() == Some(name));
        let missing = || ModelError::Missing { kind: WHAT, name: name.clone() };
        let actuator = &own.next().ok_or_else(missing)?.actuator;
        if own.next().is_some() {
            return Err(kind(WHAT, name, "one motor", "several"));
        }
        if actuator.kind != ActuatorKind::Position {
            return Err(kind(WHAT, name, "a position servo", &format!("{:?}", actuator.kind)));
        }
        if actuator.kv.is_some_and(|kv| kv != 0.0) || actuator.gear[0] != 1.0 {
            return Err(kind(WHAT, name, "no kv and a gear of 1", "others"));
        }
        let range = actuator.force_range.unwrap_or_default();
        if range[1] <= 0.0 || range[0] != -range[1] {
            return Err(kind(WHAT, name, "a symmetric forcerange", &format!("{range:?}")));
        }
        let joint = &robot.joints[place];
        if !joint.joint.limit_axes.contains(JointAxesMask::ANG_X) {
            return Err(kind("hinge", name, "a limited range", "none"));
        }
        Ok(JointActuation {
            gain: actuator.kp.unwrap_or(1.0) as f32,
            damping: joint.damping_per_dof,
            force_limit: range[1] as f32,
            armature: joint.armature_per_dof,
        })
    };
    skeleton.joints().iter().zip(&places.joints).map(motor).collect()
}

/// Physics steps in a control tick.
pub(super) fn substeps(control_hz: f32, timestep_secs: f64) -> Result<u32, ModelError> {
    let substeps = 1.0 / (f64::from(control_hz) * timestep_secs);
    let whole = substeps.round();
    if !(1.0..=1000.0).contains(&whole) || (substeps - whole).abs() > 1e-3 {
        return Err(ModelError::Timestep { control_hz, timestep_secs });
    }
    Ok(whole as u32)
}

/// The keyframe `stand`, or the pose of the MJCF itself, hinges in the skeleton's order.
pub(super) fn stand(robot: &MjcfRobot, skeleton: &Skeleton, places: &Places) -> Result<Pose, ModelError> {
    let mut pose = Pose::new(skeleton);
    let Some(key) = robot.keyframes.iter().find(|key| key.name.as_deref() == Some(STAND)) else {
        let root = robot.bodies[places.bodies[0]].body.position();
        let q = root.rotation;
        let numbers = [root.translation.x, root.translation.y, root.translation.z, q.w, q.x, q.y, q.z];
        pose.qpos[..ROOT_QPOS].copy_from_slice(&numbers.map(f64::from));
        return Ok(pose);
    };
    let mut from = 0;
    for dof in &robot.qpos_dofs {
        let (to, width) = match dof.joint.map(|joint| places.joints.iter().position(|&p| p == joint)) {
            None => (0, ROOT_QPOS),
            Some(hinge) => (ROOT_QPOS + hinge.unwrap_or_default(), 1),
        };
        let Some(numbers) = key.qpos.get(from..from + width) else { break };
        pose.qpos[to..to + width].copy_from_slice(numbers);
        from += width;
    }
    let expected = pose.qpos.len();
    let found = key.qpos.len();
    let complete =
        if found == expected { Ok(()) } else { Err(PoseError::Length { field: "qpos", expected, found }) };
    complete
        .and_then(|()| Pose::check(&pose.qpos, &pose.qvel, skeleton.joint_count()))
        .map_err(|source| ModelError::Stand { source })?;
    Ok(pose)
}
