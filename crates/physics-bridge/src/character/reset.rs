//! Resetting a character to a pose, and setting its targets and its model.

use glam::{DQuat, Quat};
use policy_core::Heading;
use policy_core::contract::{Pose, PoseError, ROOT_QPOS};

use super::Character;
use crate::description::model::Model;

/// The model is of another kind of character.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("expected a model made by `with_settings` of the character's own, found another")]
#[non_exhaustive]
pub struct ModelMismatch;

impl Character {
    /// Sets the angles that the motors pull the joints to, radians, in the order of the skeleton. They hold until
    /// the next call. Joints without a target keep theirs; targets without a joint are ignored.
    pub fn actuate(&mut self, targets: &[f32]) {
        let ctrl = self.data.ctrl_mut();
        for (&target, joint) in targets.iter().zip(&self.model.layout().joints) {
            ctrl[joint.ctrl] = f64::from(target);
        }
    }

    /// Puts the character into any position and velocity, laid out as in [`Pose`], and forgets everything else:
    /// time, targets, pushes, history. The motors hold the pose until [`Character::actuate`] is called.
    ///
    /// # Errors
    /// When there are more or fewer numbers than the character has, a number is not finite or the quaternion is no
    /// rotation; the character is then unchanged.
    pub fn set_pose(&mut self, qpos: &[f64], qvel: &[f64]) -> Result<(), PoseError> {
        Pose::check(qpos, qvel, self.model.skeleton().joint_count())?;
        self.pose_unchecked(qpos, qvel);
        self.restart_history();
        Ok(())
    }

    /// Stands the character on the ground at a point, metres, world space, facing along `heading`, its lowest
    /// point touching the ground. All of it moves along `heading` at `speed_mps`: 0 for a policy that stands,
    /// [`WALKING_START_MPS`](crate::WALKING_START_MPS) for one that only walks and would fall from a standstill. Allocates two short lists.
    ///
    /// # Errors
    /// When a number is not finite; the character is then unchanged.
    pub fn stand_at(&mut self, x: f32, y: f32, heading: Heading, speed_mps: f32) -> Result<(), PoseError> {
        let Pose { mut qpos, mut qvel } = self.model.stand().clone();
        let turn = Quat::from_rotation_z(heading.angle()).as_dquat();
        let [w, i, j, k] = [qpos[3], qpos[4], qpos[5], qpos[6]];
        let world_from_root = (turn * DQuat::from_xyzw(i, j, k, w)).normalize();
        let [i, j, k, w] = world_from_root.to_array();
        (qpos[0], qpos[1]) = (x.into(), y.into());
        qpos[2] += f64::from(self.model.height_at(x, y));
        qpos[3..7].copy_from_slice(&[w, i, j, k]);
        let velocity = heading.direction() * speed_mps;
        (qvel[0], qvel[1]) = (velocity.x.into(), velocity.y.into());
        Pose::check(&qpos, &qvel, self.model.skeleton().joint_count())?;
        self.pose_unchecked(&qpos, &qvel);
        qpos[2] -= f64::from(self.clearance());
        self.pose_unchecked(&qpos, &qvel);
        self.restart_history();
        Ok(())
    }

    /// Applies other [`Settings`](crate::Settings) from the next step on. `model` is made by
    /// [`Model::with_settings`] of this character's own.
    ///
    /// # Errors
    /// When it is of another character or terrain; the character is then unchanged.
    pub fn set_model(&mut self, model: &Model) -> Result<(), ModelMismatch> {
        if !self.model.shares_ground_with(model) {
            return Err(ModelMismatch);
        }
        self.data.try_swap_model(model.physics().clone()).map_err(|_| ModelMismatch)?;
        self.model = model.clone();
        self.data.step1(); // contacts stay: they are of the last substep
        Ok(())
    }

    fn pose_unchecked(&mut self, qpos: &[f64], qvel: &[f64]) {
        let layout = self.model.layout();
        self.data.reset();
        layout.write_qpos(qpos, self.data.qpos_mut());
        layout.write_qvel(qvel, self.data.qvel_mut());
        let ctrl = self.data.ctrl_mut();
        for (&angle, joint) in qpos[ROOT_QPOS..].iter().zip(&layout.joints) {
            ctrl[joint.ctrl] = angle;
        }
        self.tick = 0;
        self.pushes.clear();
        self.refresh();
    }
}
