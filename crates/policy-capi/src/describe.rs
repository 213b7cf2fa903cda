//! What an engine needs to build the body and to set its rates, as plain structs.

use std::mem::MaybeUninit;

use policy_core::{BodyId, NodeId, ground_lookahead_secs};

use crate::PS_NONE;
use crate::border::{id, index, output, present};
use crate::error::{PsStatus, guard, guard_or};
use crate::pack::{PsPack, absent};

/// Sizes and rates of a pack.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PsPackInfo {
    /// Bodies, the root included.
    pub body_count: usize,
    /// Hinges.
    pub joint_count: usize,
    /// Inputs of a policy: the observation, then two numbers of the target.
    pub policy_input_len: usize,
    /// Control ticks per second.
    pub control_hz: f32,
    /// Physics steps per second in training; 0 where the pack does not say.
    pub physics_hz: f32,
    /// Mass of all bodies, kilograms; 0 where the pack does not say.
    pub mass_kg: f32,
}

/// A hinge.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PsJoint {
    /// The body that it moves.
    pub body: i32,
    /// Axis in the frame of that body, of any length but zero.
    pub axis: [f32; 3],
    /// Least and greatest angle, radians. Joint targets may lie outside: don't clamp them.
    pub range: [f32; 2],
    /// Joint target of a zero action, radians.
    pub action_centre: f32,
    /// Radians of joint target per unit of action.
    pub action_gain: f32,
}

/// The motor of a hinge: `torque = clamp(gain * (target - angle), -force_limit, force_limit) - damping * velocity`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PsMotor {
    /// Newton metres per radian.
    pub gain: f32,
    /// Newton metre seconds per radian. A property of the joint: integrated implicitly, not clamped.
    pub damping: f32,
    /// Greatest torque of the gain, newton metres.
    pub force_limit: f32,
    /// Inertia of the motor about the hinge, kilogram square metres.
    pub armature: f32,
}

/// A node of the policy graph.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PsNode {
    /// A root lower than this above the ground, metres, means that the character has fallen; NaN where no height does.
    pub fall_height: f32,
    /// Speed that the policy was trained for, metres per second; NaN where it has none.
    pub speed_mps: f32,
    /// 1 for a policy that faces one way and moves another, else 0.
    pub strafes: i32,
}

/// Writes sizes and rates.
#[unsafe(no_mangle)]
pub extern "C" fn ps_pack_info(
    pack: Option<&PsPack>,
    info: Option<&mut MaybeUninit<PsPackInfo>>,
) -> PsStatus {
    guard(|| {
        let (PsPack { pack, .. }, info) = (present("a pack", pack)?, present("the place of the info", info)?);
        let (skeleton, actuation) = (pack.skeleton(), pack.actuation());
        info.write(PsPackInfo {
            body_count: skeleton.body_count(),
            joint_count: skeleton.joint_count(),
            policy_input_len: skeleton.policy_input_len(),
            control_hz: pack.control_hz(),
            physics_hz: actuation.map_or(0.0, |a| a.physics_hz),
            mass_kg: actuation.map_or(0.0, |a| a.mass_kg),
        });
        Ok(())
    })
}

/// Seconds after which the ground below a body counts for PsSensed.ground_heights: where the body then is at its present velocity.
/// Negative for a body that senses no ground of its own, and on failure.
#[unsafe(no_mangle)]
pub extern "C" fn ps_pack_ground_lookahead_secs(pack: Option<&PsPack>, body: i32) -> f32 {
    guard_or(-1.0, || {
        let skeleton = present("a pack", pack)?.pack.skeleton();
        let body = BodyId::new(index("body", body, skeleton.body_count())?);
        Ok(ground_lookahead_secs(skeleton, body).unwrap_or(-1.0))
    })
}

/// The body that a body hangs on. PS_NONE for the root and on failure.
#[unsafe(no_mangle)]
pub extern "C" fn ps_pack_parent(pack: Option<&PsPack>, body: i32) -> i32 {
    guard_or(PS_NONE, || {
        let skeleton = present("a pack", pack)?.pack.skeleton();
        let body = BodyId::new(index("body", body, skeleton.body_count())?);
        Ok(skeleton.parent(body).map_or(PS_NONE, |parent| id(parent.index())))
    })
}

/// Writes a hinge.
#[unsafe(no_mangle)]
pub extern "C" fn ps_pack_joint(
    pack: Option<&PsPack>,
    joint: i32,
    out: Option<&mut MaybeUninit<PsJoint>>,
) -> PsStatus {
    guard(|| {
        let (PsPack { pack, .. }, out) = (present("a pack", pack)?, present("the place of a joint", out)?);
        let joints = pack.skeleton().joints();
        let at = index("joint", joint, joints.len())?;
        out.write(PsJoint {
            body: id(joints[at].body.index()),
            axis: joints[at].axis.into(),
            range: joints[at].range,
            action_centre: pack.action().centre()[at],
            action_gain: pack.action().gain()[at],
        });
        Ok(())
    })
}

/// Writes the motors, one for each hinge. `capacity` is the number of entries that `motors` has room for. Packs of version 1
/// have none (PS_STATUS_ABSENT).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ps_pack_motors(
    pack: Option<&PsPack>,
    motors: *mut PsMotor,
    capacity: usize,
) -> PsStatus {
    guard(|| {
        let actuation =
            present("a pack", pack)?.pack.actuation().ok_or_else(|| absent("a motor of each joint"))?;
        // SAFETY: the contract of every function.
        let out = unsafe { output("motors", motors, capacity, actuation.joints.len()) }?;
        for (slot, joint) in out.iter_mut().zip(&actuation.joints) {
            slot.write(PsMotor {
                gain: joint.gain,
                damping: joint.damping,
                force_limit: joint.force_limit,
                armature: joint.armature,
            });
        }
        Ok(())
    })
}

/// Writes a node of the graph.
#[unsafe(no_mangle)]
pub extern "C" fn ps_pack_node(
    pack: Option<&PsPack>,
    node: i32,
    out: Option<&mut MaybeUninit<PsNode>>,
) -> PsStatus {
    guard(|| {
        let (PsPack { pack, .. }, out) = (present("a pack", pack)?, present("the place of a node", out)?);
        let node = index("node", node, pack.graph().nodes().len())?;
        let node = pack.graph().node(NodeId::new(node));
        out.write(PsNode {
            fall_height: node.fall_height.unwrap_or(f32::NAN),
            speed_mps: node.speed_mps.unwrap_or(f32::NAN),
            strafes: i32::from(node.strafes),
        });
        Ok(())
    })
}

/// Number of nodes of a path; its coordinates run from 0 to one less. 0 on failure.
#[unsafe(no_mangle)]
pub extern "C" fn ps_pack_path_len(pack: Option<&PsPack>, path: i32) -> usize {
    guard_or(0, || Ok(path_nodes(pack, path)?.len()))
}

/// Writes the nodes of a path, in the order of its coordinates. `capacity` is the number of entries that `nodes` has room
/// for.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ps_pack_path_nodes(
    pack: Option<&PsPack>,
    path: i32,
    nodes: *mut i32,
    capacity: usize,
) -> PsStatus {
    guard(|| {
        let path = path_nodes(pack, path)?;
        // SAFETY: the contract of every function.
        let out = unsafe { output("nodes", nodes, capacity, path.len()) }?;
        for (slot, node) in out.iter_mut().zip(path) {
            slot.write(id(node.index()));
        }
        Ok(())
    })
}

fn path_nodes(pack: Option<&PsPack>, path: i32) -> Result<&[NodeId], PsStatus> {
    let paths = present("a pack", pack)?.pack.graph().paths();
    Ok(paths[index("path", path, paths.len())?].nodes())
}

/// The skill that brings a fallen character to its feet. PS_NONE where there is none, and on failure.
#[unsafe(no_mangle)]
pub extern "C" fn ps_pack_recovery(pack: Option<&PsPack>) -> i32 {
    guard_or(PS_NONE, || {
        Ok(present("a pack", pack)?.pack.recovery().map_or(PS_NONE, |skill| id(skill.index())))
    })
}
