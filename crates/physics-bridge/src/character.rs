//! The mutable half: one humanoid in its world.

use std::sync::Arc;

use glam::{DVec3, Quat};
use mujoco_rs::wrappers::mj_data::MjData;
use mujoco_rs::wrappers::mj_model::MjModel;
use policy_core::{Body, CharacterState, JointTargets};

use crate::diverged::{Diverged, Warning};
use crate::model::{Model, STATE};
use crate::pose::{BodyPoses, Pose, PoseError};
use crate::{QPOS_LEN, QVEL_LEN};

/// One humanoid: made by [`Character::new`], then `sense_into`, `actuate` and `step` each control tick.
///
/// Everything derived from the state (positions of bodies, velocities) is up to date between calls.
/// Allocates when it is made, not when it is stepped.
#[derive(Debug)]
pub struct Character {
    model: Model,
    data: MjData<Arc<MjModel>>,
    tick: u64,
    /// The state before the last tick, to fall back on.
    before: Box<[f64]>,
}

impl Character {
    /// A character that stands at the origin, facing along x.
    #[must_use]
    pub fn new(model: &Model) -> Self {
        let mut data = model.new_data();
        data.step1();
        let before = vec![0.0; model.state_len()].into_boxed_slice();
        Self { model: model.clone(), data, tick: 0, before }
    }

    /// The model it was made of.
    #[must_use]
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Control ticks completed since the character was made or posed.
    #[must_use]
    pub fn tick(&self) -> u64 {
        self.tick
    }

    /// Writes what a policy senses: motion of the body frames in world axes, joint velocities, and the
    /// height of the ground below the pelvis.
    pub fn sense_into(&self, out: &mut CharacterState) {
        let layout = self.model.layout();
        let (xpos, xquat, cvel) = (self.data.xpos(), self.data.xquat(), self.data.cvel());
        // MuJoCo's velocities are of the point that moves with the body and is now at the root's centre of mass.
        let reference = DVec3::from(self.data.subtree_com()[layout.body_ids[Body::Pelvis.index()]]);
        for (body, &id) in out.bodies.iter_mut().zip(&layout.body_ids) {
            let [wx, wy, wz, vx, vy, vz] = cvel[id];
            let (angular, linear) = (DVec3::new(wx, wy, wz), DVec3::new(vx, vy, vz));
            let position = DVec3::from(xpos[id]);
            body.position = position.as_vec3();
            body.rotation = rotation(xquat[id]);
            body.linear_velocity = (linear + angular.cross(position - reference)).as_vec3();
            body.angular_velocity = angular.as_vec3();
        }
        let qvel = self.data.qvel();
        for (velocity, &dof) in out.joint_velocities.iter_mut().zip(&layout.joint_dof) {
            *velocity = qvel[dof] as f32;
        }
        let pelvis = out.body(Body::Pelvis).position;
        out.ground_height = self.model.height_at(pelvis.x, pelvis.y);
    }

    /// Sets the angles that the motors pull the joints to, radians. They hold until the next call.
    pub fn actuate(&mut self, targets: &JointTargets) {
        let ctrl = self.data.ctrl_mut();
        for (&target, &index) in targets.0.iter().zip(&self.model.layout().joint_ctrl) {
            ctrl[index] = f64::from(target);
        }
    }

    /// Runs one control tick of physics.
    ///
    /// # Errors
    /// When the motion is no longer finite or MuJoCo warns. The character is then back in its state before
    /// the tick.
    pub fn step(&mut self) -> Result<(), Diverged> {
        self.data.read_state_into(STATE, &mut self.before);
        for substep in 0..self.model.substeps() {
            // The two halves of `mj_step`, turned round, so that everything derived from the state is up to
            // date when the tick ends.
            self.data.step2();
            self.data.step1();
            if let Some(index) = self.data.warning().iter().position(|w| w.number > 0) {
                return Err(self.diverge(substep, index));
            }
        }
        self.tick += 1;
        Ok(())
    }

    /// Writes where the bodies are.
    pub fn poses_into(&self, out: &mut BodyPoses) {
        let (xpos, xquat) = (self.data.xpos(), self.data.xquat());
        for (index, &id) in self.model.layout().body_ids.iter().enumerate() {
            out.positions[index] = DVec3::from(xpos[id]).as_vec3();
            out.rotations[index] = rotation(xquat[id]);
        }
    }

    /// Puts the character into any position and velocity, and forgets everything else: time, targets, pushes.
    /// The motors hold the pose until [`Character::actuate`] is called.
    ///
    /// # Errors
    /// When a number is not finite or the quaternion is no rotation; the character is then unchanged.
    pub fn set_pose(&mut self, qpos: &[f64; QPOS_LEN], qvel: &[f64; QVEL_LEN]) -> Result<(), PoseError> {
        Pose::check(qpos, qvel)?;
        let layout = self.model.layout();
        self.data.reset();
        let (root_qpos, root_dof) = (layout.root_qpos, layout.root_dof);
        let to = self.data.qpos_mut();
        to[root_qpos..root_qpos + 7].copy_from_slice(&qpos[..7]);
        for (&angle, &index) in qpos[7..].iter().zip(&layout.joint_qpos) {
            to[index] = angle;
        }
        let to = self.data.qvel_mut();
        to[root_dof..root_dof + 6].copy_from_slice(&qvel[..6]);
        for (&velocity, &index) in qvel[6..].iter().zip(&layout.joint_dof) {
            to[index] = velocity;
        }
        let to = self.data.ctrl_mut();
        for (&angle, &index) in qpos[7..].iter().zip(&layout.joint_ctrl) {
            to[index] = angle;
        }
        self.data.step1();
        self.tick = 0;
        Ok(())
    }

    /// Position and velocity now.
    #[must_use]
    pub fn pose(&self) -> Pose {
        let layout = self.model.layout();
        let mut pose = Pose { qpos: [0.0; QPOS_LEN], qvel: [0.0; QVEL_LEN] };
        let from = self.data.qpos();
        pose.qpos[..7].copy_from_slice(&from[layout.root_qpos..layout.root_qpos + 7]);
        for (angle, &index) in pose.qpos[7..].iter_mut().zip(&layout.joint_qpos) {
            *angle = from[index];
        }
        let from = self.data.qvel();
        pose.qvel[..6].copy_from_slice(&from[layout.root_dof..layout.root_dof + 6]);
        for (velocity, &index) in pose.qvel[6..].iter_mut().zip(&layout.joint_dof) {
            *velocity = from[index];
        }
        pose
    }

    /// Reads the warning, then returns to the state before the tick.
    fn diverge(&mut self, substep: u32, warning: usize) -> Diverged {
        let info = self.data.warning()[warning].lastinfo;
        let body = None;
        let _ = info;
        self.data.reset();
        self.data.set_state(&self.before, STATE).expect("the buffer was made for this model");
        self.data.step1();
        Diverged { tick: self.tick, substep, warning: Warning::ALL[warning], body }
    }
}

/// MuJoCo's wxyz quaternion in single precision.
fn rotation([w, x, y, z]: [f64; 4]) -> Quat {
    Quat::from_xyzw(x as f32, y as f32, z as f32, w as f32)
}
