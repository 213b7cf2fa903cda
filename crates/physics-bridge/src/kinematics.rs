//! Motion of the bodies of one character, read out of a simulation: of its own or of a shared one. Knows no more than
//! the description.

use glam::DVec3;
use mujoco_rs::wrappers::mj_data::MjData;
use mujoco_rs::wrappers::mj_model::traits::ModelType;
use policy_core::CharacterState;
use policy_core::contract::{MAX_DEPTH_M, MAX_DISTANCE_M, MAX_SPEED_MPS, MAX_SPIN_RADPS};

use crate::cause::{Cause, Excess};
use crate::description::body_poses::{BodyPoses, rotation};
use crate::description::layout::Layout;

/// Writes what a policy senses of a character, but for the ground.
pub(crate) fn sense_into<M: ModelType>(data: &MjData<M>, layout: &Layout, out: &mut CharacterState) {
    let (xpos, xquat, cvel) = (data.xpos(), data.xquat(), data.cvel());
    let reference = velocity_reference(data, layout);
    for (body, &id) in out.bodies.iter_mut().zip(&layout.body_ids) {
        let position = DVec3::from(xpos[id]);
        let (angular, linear) = velocity_at(cvel[id], position - reference);
        body.position = position.as_vec3();
        body.rotation = rotation(xquat[id]);
        body.linear_velocity = linear.as_vec3();
        body.angular_velocity = angular.as_vec3();
    }
    let qvel = data.qvel();
    for (velocity, joint) in out.joint_velocities.iter_mut().zip(&layout.joints) {
        *velocity = qvel[joint.dof] as f32;
    }
}

/// Writes where the bodies of a character are. Allocates only when `out` is of another skeleton.
pub(crate) fn poses_into<M: ModelType>(data: &MjData<M>, layout: &Layout, out: &mut BodyPoses) {
    let (xpos, xquat) = (data.xpos(), data.xquat());
    out.positions.clear();
    out.positions.extend(layout.body_ids.iter().map(|&id| DVec3::from(xpos[id]).as_vec3()));
    out.rotations.clear();
    out.rotations.extend(layout.body_ids.iter().map(|&id| rotation(xquat[id])));
}

/// The point that MuJoCo's body velocities are of: it moves with the body, and is now where the centre of mass of
/// the whole character is.
pub(crate) fn velocity_reference<M: ModelType>(data: &MjData<M>, layout: &Layout) -> DVec3 {
    DVec3::from(data.subtree_com()[layout.body_ids[0]])
}

/// Angular velocity, and linear velocity `offset` away from the reference point.
pub(crate) fn velocity_at([wx, wy, wz, vx, vy, vz]: [f64; 6], offset: DVec3) -> (DVec3, DVec3) {
    let angular = DVec3::new(wx, wy, wz);
    (angular, DVec3::new(vx, vy, vz) + angular.cross(offset))
}

/// The first fault, in the order of [`Cause`], of a body at a place that moves in some way. MuJoCo itself stops only
/// at numbers that are not finite or above 1e10; a simulation has diverged long before that.
pub(crate) fn fault(
    position: DVec3,
    (angular, linear): (DVec3, DVec3),
    ground: f32,
) -> Option<(Cause, Excess)> {
    let checks = [
        (Cause::SpinsTooFast, angular.length(), MAX_SPIN_RADPS),
        (Cause::TooFast, linear.length(), MAX_SPEED_MPS),
        (Cause::BelowGround, f64::from(ground) - position.z, MAX_DEPTH_M),
        (Cause::TooFarAway, position.length(), MAX_DISTANCE_M),
    ];
    // Numbers that are not finite are MuJoCo's to find; a NaN fails no comparison here.
    let (cause, value, limit) = checks.into_iter().find(|&(_, value, limit)| value > limit.into())?;
    Some((cause, Excess { value: value as f32, limit }))
}
