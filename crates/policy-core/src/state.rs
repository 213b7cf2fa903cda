//! What the physics tells of a character each control tick. SI units, world space, z up.

use glam::{Quat, Vec3};

use crate::body::{BODY_COUNT, Body, DOF_COUNT};

/// Motion of one body: its frame (not its centre of mass) in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyState {
    /// Origin of the body frame, metres.
    pub position: Vec3,
    /// `world_from_body`, a unit quaternion.
    pub rotation: Quat,
    /// Velocity of the frame's origin, metres per second.
    pub linear_velocity: Vec3,
    /// Radians per second about the world axes.
    pub angular_velocity: Vec3,
}

impl Default for BodyState {
    fn default() -> Self {
        Self {
            position: Vec3::ZERO,
            rotation: Quat::IDENTITY,
            linear_velocity: Vec3::ZERO,
            angular_velocity: Vec3::ZERO,
        }
    }
}

/// Everything a [`Controller`](crate::Controller) needs to sense of its character.
///
/// Positions are single precision: within 1 km of the origin they lose less than 0.1 mm. A larger
/// world subtracts an origin of its own before it fills this in, from the target too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CharacterState {
    /// One entry for each [`Body`], in index order.
    pub bodies: [BodyState; BODY_COUNT],
    /// Angular velocity of every hinge in the order of [`JOINT_NAMES`](crate::JOINT_NAMES), radians per second.
    pub joint_velocities: [f32; DOF_COUNT],
    /// Height of the ground below the pelvis, metres.
    pub ground_height: f32,
}

impl CharacterState {
    /// Motion of `body`.
    #[must_use]
    pub fn body(&self, body: Body) -> &BodyState {
        &self.bodies[body.index()]
    }

    /// Height of the frame of `body` above the ground below the pelvis, metres.
    #[must_use]
    pub fn height_of(&self, body: Body) -> f32 {
        self.body(body).position.z - self.ground_height
    }

    /// True when every number is finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.ground_height.is_finite()
            && self.joint_velocities.iter().all(|v| v.is_finite())
            && self.bodies.iter().all(|b| {
                b.position.is_finite()
                    && b.rotation.is_finite()
                    && b.linear_velocity.is_finite()
                    && b.angular_velocity.is_finite()
            })
    }
}

impl Default for CharacterState {
    fn default() -> Self {
        Self {
            bodies: [BodyState::default(); BODY_COUNT],
            joint_velocities: [0.0; DOF_COUNT],
            ground_height: 0.0,
        }
    }
}

/// Joint angles the motors are to reach, radians, in the order of [`JOINT_NAMES`](crate::JOINT_NAMES).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointTargets(pub [f32; DOF_COUNT]);

impl Default for JointTargets {
    fn default() -> Self {
        Self([0.0; DOF_COUNT])
    }
}
