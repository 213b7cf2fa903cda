//! Where the bodies, joints and motors of a skeleton are in a MuJoCo model, found by name once, at load.
//! Refuses a model with anything missing, of the wrong kind, or left over.

use mujoco_rs::wrappers::mj_model::{MjModel, MjtBias, MjtGain, MjtObjBase};
use policy_core::contract::{ROOT_QPOS, ROOT_QVEL};
use policy_core::{ActuationContract, BodyId, JointActuation, Skeleton};

use super::file::quoted;
use super::model_error::ModelError;
use super::skeleton;

/// Index maps from the skeleton's order into MuJoCo's arrays.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    /// MuJoCo's id of each body.
    pub body_ids: Box<[usize]>,
    /// The body of each of MuJoCo's ids; `None` for the world and what is fixed to it.
    pub bodies: Box<[Option<BodyId>]>,
    /// First of the root's seven numbers in `qpos`.
    pub root_qpos: usize,
    /// First of the root's six numbers in `qvel`.
    pub root_dof: usize,
    /// Where each hinge is.
    pub joints: Box<[JointPlace]>,
}

/// Where a hinge and its motor are in MuJoCo's arrays.
#[derive(Clone, Copy, Debug)]
pub(crate) struct JointPlace {
    /// The body that it moves.
    pub body: BodyId,
    /// Index in `qpos`.
    pub qpos: usize,
    /// Index in `qvel`.
    pub dof: usize,
    /// Index of the motor in `ctrl`.
    pub ctrl: usize,
    /// Index of the motor among the actuators.
    pub actuator: usize,
}

impl Layout {
    pub(super) fn of(model: &MjModel, skeleton: &Skeleton) -> Result<Self, ModelError> {
        let joints = skeleton.joint_count();
        expect_count("numbers in qpos", ROOT_QPOS + joints, model.nq())?;
        expect_count("numbers in qvel", ROOT_QVEL + joints, model.nv())?;
        expect_count("actuator inputs", joints, model.nu())?;
        let body_id = |body: &str| {
            let missing = || ModelError::Missing { kind: "body", name: quoted(body) };
            model.name_to_id(MjtObjBase::mjOBJ_BODY, body).ok_or_else(missing)
        };
        let body_ids = skeleton.bodies().iter().map(|b| body_id(&b.name)).collect::<Result<Box<[_]>, _>>()?;
        let mut bodies = vec![None; model.nbody() as usize].into_boxed_slice();
        for (index, &id) in body_ids.iter().enumerate() {
            bodies[id] = Some(BodyId::new(index));
        }
        let free = model.body_jntadr()[skeleton::root(model)?] as usize;
        let place = |joint: &policy_core::training::SkeletonJoint| place(model, &joint.name, joint.body);
        Ok(Self {
            body_ids,
            bodies,
            root_qpos: model.jnt_qposadr()[free] as usize,
            root_dof: model.jnt_dofadr()[free] as usize,
            joints: skeleton.joints().iter().map(place).collect::<Result<_, _>>()?,
        })
    }

    /// Of a character that was attached to a larger model, its names behind `prefix`. `bodies` stays empty.
    pub(crate) fn attached(model: &MjModel, skeleton: &Skeleton, prefix: &str) -> Result<Self, ModelError> {
        let body_id = |body: &str| {
            let missing = || ModelError::Missing { kind: "body", name: quoted(body) };
            model.name_to_id(MjtObjBase::mjOBJ_BODY, &format!("{prefix}{body}")).ok_or_else(missing)
        };
        let body_ids = skeleton.bodies().iter().map(|b| body_id(&b.name)).collect::<Result<Box<[_]>, _>>()?;
        // MuJoCo has compiled the model: what it says of its parts are indices of its own arrays.
        let free = model.body_jntadr()[body_ids[0]] as usize;
        let place = |joint: &policy_core::training::SkeletonJoint| {
            place(model, &format!("{prefix}{}", joint.name), joint.body)
        };
        Ok(Self {
            body_ids,
            bodies: Box::default(),
            root_qpos: model.jnt_qposadr()[free] as usize,
            root_dof: model.jnt_dofadr()[free] as usize,
            joints: skeleton.joints().iter().map(place).collect::<Result<_, _>>()?,
        })
    }

    /// Writes MuJoCo's `qpos` in our order.
    pub(crate) fn our_qpos(&self, theirs: &[f64], ours: &mut [f64]) {
        let (root, hinges) = ours.split_at_mut(ROOT_QPOS);
        root.copy_from_slice(&theirs[self.root_qpos..][..ROOT_QPOS]);
        hinges.iter_mut().zip(&self.joints).for_each(|(angle, joint)| *angle = theirs[joint.qpos]);
    }

    /// Writes MuJoCo's `qvel` in our order.
    pub(crate) fn our_qvel(&self, theirs: &[f64], ours: &mut [f64]) {
        let (root, hinges) = ours.split_at_mut(ROOT_QVEL);
        root.copy_from_slice(&theirs[self.root_dof..][..ROOT_QVEL]);
        hinges.iter_mut().zip(&self.joints).for_each(|(velocity, joint)| *velocity = theirs[joint.dof]);
    }

    /// Writes our `qpos` in MuJoCo's order.
    pub(crate) fn write_qpos(&self, ours: &[f64], theirs: &mut [f64]) {
        theirs[self.root_qpos..][..ROOT_QPOS].copy_from_slice(&ours[..ROOT_QPOS]);
        ours[ROOT_QPOS..].iter().zip(&self.joints).for_each(|(&angle, joint)| theirs[joint.qpos] = angle);
    }

    /// Writes our `qvel` in MuJoCo's order.
    pub(crate) fn write_qvel(&self, ours: &[f64], theirs: &mut [f64]) {
        theirs[self.root_dof..][..ROOT_QVEL].copy_from_slice(&ours[..ROOT_QVEL]);
        ours[ROOT_QVEL..]
            .iter()
            .zip(&self.joints)
            .for_each(|(&velocity, joint)| theirs[joint.dof] = velocity);
    }

    /// Multiplies the stiffness and the greatest torque of every motor.
    pub(crate) fn scale_strength(&self, model: &mut MjModel, strength: f64) {
        for actuator in self.joints.iter().map(|joint| joint.actuator) {
            // SAFETY: only motors of fixed gain are accepted, whose first gain parameter is a factor: MuJoCo uses
            // it as an index of nothing.
            unsafe { model.actuator_gainprm_mut()[actuator][0] *= strength };
            let [_, position, velocity, ..] = &mut model.actuator_biasprm_mut()[actuator];
            *position *= strength;
            *velocity *= strength;
            model.actuator_forcerange_mut()[actuator].iter_mut().for_each(|f| *f *= strength);
        }
    }

    /// How the motors of a compiled model are driven.
    pub(super) fn actuation(&self, model: &MjModel) -> ActuationContract {
        let joint = |joint: &JointPlace| JointActuation {
            gain: model.actuator_gainprm()[joint.actuator][0] as f32,
            damping: model.dof_damping()[joint.dof] as f32,
            force_limit: model.actuator_forcerange()[joint.actuator][1] as f32,
            armature: model.dof_armature()[joint.dof] as f32,
        };
        ActuationContract {
            physics_hz: (1.0 / model.opt().timestep) as f32,
            mass_kg: model.body_subtreemass()[self.body_ids[0]] as f32,
            joints: self.joints.iter().map(joint).collect(),
        }
    }
}

fn expect_count(what: &'static str, expected: usize, found: impl Into<i64>) -> Result<(), ModelError> {
    let found = usize::try_from(found.into()).unwrap_or(0);
    if found == expected { Ok(()) } else { Err(ModelError::Count { what, expected, found }) }
}

fn place(model: &MjModel, name: &str, body: BodyId) -> Result<JointPlace, ModelError> {
    let missing = |kind| ModelError::Missing { kind, name: quoted(name) };
    let joint = model.name_to_id(MjtObjBase::mjOBJ_JOINT, name).ok_or_else(|| missing("joint"))?;
    let drives = |&actuator: &usize| model.actuator_trnid()[actuator][0] as usize == joint;
    let mut motors = (0..model.nactuator() as usize).filter(drives);
    let actuator = motors.next().ok_or_else(|| missing("motor of the joint"))?;
    let expect = |fits: bool, expected| {
        let name = quoted(name);
        if fits { Ok(()) } else { Err(ModelError::Kind { kind: "motor of joint", name, expected }) }
    };
    expect(motors.next().is_none(), "one motor alone")?;
    // MuJoCo has compiled the model: what it says of its parts are indices of its own arrays.
    let [offset, position, velocity, ..] = model.actuator_biasprm()[actuator];
    let is_servo = model.actuator_gaintype()[actuator] == MjtGain::mjGAIN_FIXED
        && model.actuator_biastype()[actuator] == MjtBias::mjBIAS_AFFINE
        && model.actuator_ctrlnum()[actuator] == 1
        && offset == 0.0
        && position == -model.actuator_gainprm()[actuator][0]
        && model.actuator_gear()[actuator][0] == 1.0;
    expect(is_servo, "a position servo of gear 1")?;
    expect(velocity == 0.0, "a servo without kv (damping belongs to the joint)")?;
    let [low, high] = model.actuator_forcerange()[actuator];
    let limited = model.actuator_forcelimited()[actuator] && low == -high && high.is_finite();
    expect(limited, "a symmetric forcerange")?;
    Ok(JointPlace {
        body,
        qpos: model.jnt_qposadr()[joint] as usize,
        dof: model.jnt_dofadr()[joint] as usize,
        ctrl: model.actuator_ctrladr()[actuator] as usize,
        actuator,
    })
}
