//! What holds props to each other and to the world.

use policy_core::contract::Joint;
use policy_core::glam::{Quat, Vec3};
use rapier3d::dynamics::{
    GenericJointBuilder, JointAxesMask, JointAxis, MotorModel, RigidBodyBuilder, RigidBodyHandle,
    RopeJointBuilder,
};
use rapier3d::math::Pose;

use super::{MOST, World, WorldError};

/// Axes of a ball joint that turn.
const TURNING: [JointAxis; 3] = [JointAxis::AngX, JointAxis::AngY, JointAxis::AngZ];

impl World {
    /// Joins a prop to another one, or to the world for `None`, where they are now. Two props that a hinge, slide or ball joint
    /// joins do not touch each other. Allocates.
    ///
    /// # Errors
    /// When a number of the joint is out of its range, there is no such prop, the two are one, or the world has as many joints as
    /// it may have.
    pub fn join(&mut self, prop: usize, other: Option<usize>, joint: &Joint) -> Result<(), WorldError> {
        joint.check()?;
        if self.joints >= MOST {
            return Err(WorldError::Full { what: "joints", most: MOST });
        }
        if other == Some(prop) {
            return Err(WorldError::Loop);
        }
        let body = self.prop_body(prop)?;
        let held_by = match other {
            Some(other) => self.prop_body(other)?,
            None => self.pillar(),
        };
        // A joint's frame is given in each of the two bodies.
        let inside = |handle: RigidBodyHandle, at: Vec3, turn: Quat| {
            self.world.bodies[handle].position().inverse() * Pose::from_parts(at, turn)
        };
        let built = |free: JointAxesMask, at: Vec3, turn: Quat| {
            GenericJointBuilder::new(JointAxesMask::all() - free)
                .local_frame1(inside(held_by, at, turn))
                .local_frame2(inside(body, at, turn))
                .contacts_enabled(false)
        };
        let damped = |builder: GenericJointBuilder, axis: JointAxis, damping: f32| match damping {
            0.0 => builder,
            damping => builder.motor_model(axis, MotorModel::ForceBased).motor_velocity(axis, 0.0, damping),
        };
        let limited = |builder: GenericJointBuilder, axis: JointAxis, range: Option<[f32; 2]>| match range {
            Some(range) => builder.limits(axis, range),
            None => builder,
        };
        // Rapier's joints turn about x and slide along x.
        let along_x = |axis: Vec3| Quat::from_rotation_arc(Vec3::X, axis.normalize());
        let joint = match *joint {
            Joint::Hinge { anchor, axis, range, damping } => {
                let hinge = built(JointAxesMask::ANG_X, anchor, along_x(axis));
                damped(limited(hinge, JointAxis::AngX, range), JointAxis::AngX, damping).build()
            }
            Joint::Slide { axis, range, damping } => {
                let at = self.world.bodies[body].translation();
                let slide = built(JointAxesMask::LIN_X, at, along_x(axis));
                damped(limited(slide, JointAxis::LinX, range), JointAxis::LinX, damping).build()
            }
            Joint::Ball { anchor, damping } => {
                let ball = built(JointAxesMask::ANG_AXES, anchor, Quat::IDENTITY);
                TURNING.into_iter().fold(ball, |ball, axis| damped(ball, axis, damping)).build()
            }
            Joint::Rope { ends: [on_prop, on_other], length } => RopeJointBuilder::new(length)
                .local_anchor1(inside(held_by, on_other, Quat::IDENTITY).translation)
                .local_anchor2(inside(body, on_prop, Quat::IDENTITY).translation)
                .build()
                .into(),
        };
        self.world.impulse_joints.insert(held_by, body, joint, true);
        self.joints += 1;
        Ok(())
    }

    /// Joints of props in it.
    #[must_use]
    pub fn joint_count(&self) -> usize {
        self.joints
    }

    /// The body that holds what is joined to the world.
    fn pillar(&mut self) -> RigidBodyHandle {
        *self.pillar.get_or_insert_with(|| self.world.bodies.insert(RigidBodyBuilder::fixed()))
    }
}
