//! Where the bodies, joints and motors of policy-core are in a MuJoCo model, found by name once, at load.
//! Refuses a model that is not the humanoid: anything missing, of the wrong kind, or left over.

use mujoco_rs::wrappers::mj_model::{MjModel, MjtBias, MjtGain, MjtJoint, MjtObjBase, MjtTrn};
use policy_core::{BODY_COUNT, BODY_NAMES, Body, DOF_COUNT, JOINT_NAMES};

use crate::diverged::Cause;
use crate::model_error::ModelError;
use crate::{QPOS_LEN, QVEL_LEN};

/// Index maps from policy-core's order into MuJoCo's arrays.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    /// MuJoCo's id of each [`Body`].
    pub body_ids: [usize; BODY_COUNT],
    /// The [`Body`] of each of MuJoCo's ids; `None` for the world.
    pub bodies: Box<[Option<Body>]>,
    /// First of the root's seven numbers in `qpos`.
    pub root_qpos: usize,
    /// First of the root's six numbers in `qvel`.
    pub root_dof: usize,
    /// Index of each hinge in `qpos`.
    pub joint_qpos: [usize; DOF_COUNT],
    /// Index of each hinge in `qvel`.
    pub joint_dof: [usize; DOF_COUNT],
    /// Index of each joint's motor in `ctrl`.
    pub joint_ctrl: [usize; DOF_COUNT],
    /// Index of each joint's motor among the actuators.
    pub joint_actuator: [usize; DOF_COUNT],
    /// The body that each number of `qpos` moves.
    pub qpos_body: [Body; QPOS_LEN],
    /// The body that each number of `qvel` moves.
    pub dof_body: [Body; QVEL_LEN],
    /// Lower and upper limit of each hinge, radians.
    pub limits: [[f64; 2]; DOF_COUNT],
}

impl Layout {
    pub(crate) fn of(model: &MjModel) -> Result<Self, ModelError> {
        expect_count("numbers in qpos", QPOS_LEN, model.nq())?;
        expect_count("numbers in qvel", QVEL_LEN, model.nv())?;
        expect_count("actuator inputs", DOF_COUNT, model.nu())?;
        let body_ids = body_ids(model)?;
        let mut bodies = vec![None; model.nbody() as usize].into_boxed_slice();
        for (body, &id) in Body::ALL.into_iter().zip(&body_ids) {
            bodies[id] = Some(body);
        }
        let root = root_joint(model, body_ids[Body::Pelvis.index()])?;
        let mut layout = Self {
            body_ids,
            bodies,
            root_qpos: model.jnt_qposadr()[root] as usize,
            root_dof: model.jnt_dofadr()[root] as usize,
            joint_qpos: [0; DOF_COUNT],
            joint_dof: [0; DOF_COUNT],
            joint_ctrl: [0; DOF_COUNT],
            joint_actuator: [0; DOF_COUNT],
            qpos_body: [Body::Pelvis; QPOS_LEN],
            dof_body: [Body::Pelvis; QVEL_LEN],
            limits: [[0.0; 2]; DOF_COUNT],
        };
        for (index, name) in JOINT_NAMES.into_iter().enumerate() {
            let joint = hinge(model, name)?;
            let actuator = motor(model, name, joint)?;
            let body = layout.bodies[model.jnt_bodyid()[joint] as usize];
            let body =
                body.ok_or(ModelError::Kind { kind: "joint", name, expected: "a body of the humanoid" })?;
            layout.joint_qpos[index] = model.jnt_qposadr()[joint] as usize;
            layout.joint_dof[index] = model.jnt_dofadr()[joint] as usize;
            layout.qpos_body[layout.joint_qpos[index]] = body;
            layout.dof_body[layout.joint_dof[index]] = body;
            layout.joint_actuator[index] = actuator;
            layout.joint_ctrl[index] = model.actuator_ctrladr()[actuator] as usize;
            layout.limits[index] = model.jnt_range()[joint];
        }
        Ok(layout)
    }

    /// Our order of MuJoCo's `qpos`.
    pub(crate) fn our_qpos(&self, theirs: &[f64]) -> [f64; QPOS_LEN] {
        let mut ours = [0.0; QPOS_LEN];
        ours[..7].copy_from_slice(&theirs[self.root_qpos..self.root_qpos + 7]);
        ours[7..].iter_mut().zip(&self.joint_qpos).for_each(|(angle, &index)| *angle = theirs[index]);
        ours
    }

    /// Our order of MuJoCo's `qvel`.
    pub(crate) fn our_qvel(&self, theirs: &[f64]) -> [f64; QVEL_LEN] {
        let mut ours = [0.0; QVEL_LEN];
        ours[..6].copy_from_slice(&theirs[self.root_dof..self.root_dof + 6]);
        ours[6..].iter_mut().zip(&self.joint_dof).for_each(|(velocity, &index)| *velocity = theirs[index]);
        ours
    }

    /// Writes our `qpos` in MuJoCo's order.
    pub(crate) fn write_qpos(&self, ours: &[f64; QPOS_LEN], theirs: &mut [f64]) {
        theirs[self.root_qpos..self.root_qpos + 7].copy_from_slice(&ours[..7]);
        ours[7..].iter().zip(&self.joint_qpos).for_each(|(&angle, &index)| theirs[index] = angle);
    }

    /// Writes our `qvel` in MuJoCo's order.
    pub(crate) fn write_qvel(&self, ours: &[f64; QVEL_LEN], theirs: &mut [f64]) {
        theirs[self.root_dof..self.root_dof + 6].copy_from_slice(&ours[..6]);
        ours[6..].iter().zip(&self.joint_dof).for_each(|(&velocity, &index)| theirs[index] = velocity);
    }

    /// The body that a number named by a warning of MuJoCo belongs to.
    pub(crate) fn body_of(&self, warning: Cause, index: usize) -> Option<Body> {
        match warning {
            Cause::BadPosition => self.qpos_body.get(index).copied(),
            Cause::BadVelocity | Cause::BadAcceleration | Cause::SingularInertia => {
                self.dof_body.get(index).copied()
            }
            Cause::BadControl => {
                let joint = self.joint_ctrl.iter().position(|&ctrl| ctrl == index)?;
                self.dof_body.get(self.joint_dof[joint]).copied()
            }
            _ => None,
        }
    }
}

fn expect_count(what: &'static str, expected: usize, found: impl Into<i64>) -> Result<(), ModelError> {
    let found = found.into();
    if found == expected as i64 { Ok(()) } else { Err(ModelError::Count { what, expected, found }) }
}

fn body_ids(model: &MjModel) -> Result<[usize; BODY_COUNT], ModelError> {
    let mut ids = [0; BODY_COUNT];
    for (id, name) in ids.iter_mut().zip(BODY_NAMES) {
        *id = model
            .name_to_id(MjtObjBase::mjOBJ_BODY, name)
            .ok_or(ModelError::Missing { kind: "body", name })?;
    }
    Ok(ids)
}

fn root_joint(model: &MjModel, pelvis: usize) -> Result<usize, ModelError> {
    let first = model.body_jntadr()[pelvis];
    usize::try_from(first)
        .ok()
        .filter(|&joint| {
            model.jnt_type()[joint] == MjtJoint::mjJNT_FREE && model.body_parentid()[pelvis] == 0
        })
        .ok_or(ModelError::FixedPelvis)
}

fn hinge(model: &MjModel, name: &'static str) -> Result<usize, ModelError> {
    let joint =
        model.name_to_id(MjtObjBase::mjOBJ_JOINT, name).ok_or(ModelError::Missing { kind: "joint", name })?;
    if model.jnt_type()[joint] != MjtJoint::mjJNT_HINGE {
        return Err(ModelError::Kind { kind: "joint", name, expected: "a hinge" });
    }
    if !model.jnt_limited()[joint] {
        return Err(ModelError::Kind { kind: "joint", name, expected: "a limited range" });
    }
    Ok(joint)
}

fn motor(model: &MjModel, name: &'static str, joint: usize) -> Result<usize, ModelError> {
    let actuator = model
        .name_to_id(MjtObjBase::mjOBJ_ACTUATOR, name)
        .ok_or(ModelError::Missing { kind: "actuator", name })?;
    let drives_the_joint = model.actuator_trntype()[actuator] == MjtTrn::mjTRN_JOINT
        && model.actuator_trnid()[actuator][0] == joint as i32;
    if !drives_the_joint {
        return Err(ModelError::Kind { kind: "actuator", name, expected: "the joint of its own name" });
    }
    let is_servo = model.actuator_gaintype()[actuator] == MjtGain::mjGAIN_FIXED
        && model.actuator_biastype()[actuator] == MjtBias::mjBIAS_AFFINE
        && model.actuator_ctrlnum()[actuator] == 1;
    if !is_servo {
        return Err(ModelError::Kind { kind: "actuator", name, expected: "a position servo" });
    }
    Ok(actuator)
}
