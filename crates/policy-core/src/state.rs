//! What the physics tells of a character each control tick. SI units, world space, z up.

use alloc::vec::Vec;
use core::ops::{Deref, DerefMut};

use glam::{Quat, Vec3};

use crate::ids::BodyId;
use crate::skeleton::Skeleton;

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
/// It is sized for a skeleton once; a tick overwrites its numbers. Positions are single precision: within 1 km of
/// the origin they lose less than 0.1 mm. A larger world subtracts an origin of its own first, from the target too.
#[derive(Clone, Debug, PartialEq)]
pub struct CharacterState {
    /// One entry for each body of the skeleton, in its order.
    pub bodies: Vec<BodyState>,
    /// Angular velocity of every hinge in the skeleton's order, radians per second.
    pub joint_velocities: Vec<f32>,
    /// Height of the ground below the root, metres.
    pub ground_height: f32,
    /// For each body, how much higher the ground that it comes to is than that below the root, metres, within
    /// [`MAX_RISE_METRES`](crate::MAX_RISE_METRES). Zero on level ground and where nothing is known;
    /// [`CharacterState::sense_ground`] sets those of the legs.
    pub ground_rises: Vec<f32>,
}

impl CharacterState {
    /// A state at the origin, at rest. Allocates.
    #[must_use]
    pub fn new(skeleton: &Skeleton) -> Self {
        Self {
            bodies: alloc::vec![BodyState::default(); skeleton.body_count()],
            joint_velocities: alloc::vec![0.0; skeleton.joint_count()],
            ground_height: 0.0,
            ground_rises: alloc::vec![0.0; skeleton.body_count()],
        }
    }

    /// Motion of a body.
    ///
    /// # Panics
    /// When the state has no such body.
    #[must_use]
    pub fn body(&self, id: BodyId) -> &BodyState {
        &self.bodies[id.index()]
    }

    /// Motion of a body, to be written.
    ///
    /// # Panics
    /// When the state has no such body.
    #[must_use]
    pub fn body_mut(&mut self, id: BodyId) -> &mut BodyState {
        &mut self.bodies[id.index()]
    }

    /// Motion of the root.
    ///
    /// # Panics
    /// When the state has no body.
    #[must_use]
    pub fn root(&self) -> &BodyState {
        &self.bodies[0]
    }

    /// Height of a body's frame above the ground below the root, metres.
    ///
    /// # Panics
    /// When the state has no such body.
    #[must_use]
    pub fn height_of(&self, id: BodyId) -> f32 {
        self.body(id).position.z - self.ground_height
    }

    /// Height of the root's frame above the ground below it, metres.
    ///
    /// # Panics
    /// When the state has no body.
    #[must_use]
    pub fn root_height(&self) -> f32 {
        self.root().position.z - self.ground_height
    }

    /// Horizontal speed of the root, metres per second.
    ///
    /// # Panics
    /// When the state has no body.
    #[must_use]
    pub fn horizontal_speed(&self) -> f32 {
        self.root().linear_velocity.truncate().length()
    }

    /// True when it has the bodies and hinges of `skeleton`.
    #[must_use]
    pub fn fits(&self, skeleton: &Skeleton) -> bool {
        self.bodies.len() == skeleton.body_count()
            && self.ground_rises.len() == self.bodies.len()
            && self.joint_velocities.len() == skeleton.joint_count()
    }

    /// Copies the numbers of `other`. Allocates only when the sizes differ.
    pub fn copy_from(&mut self, other: &Self) {
        self.bodies.clone_from(&other.bodies);
        self.joint_velocities.clone_from(&other.joint_velocities);
        self.ground_height = other.ground_height;
        self.ground_rises.clone_from(&other.ground_rises);
    }

    /// Copies what `other`, of the same skeleton, senses of the ground. Does not allocate.
    ///
    /// # Panics
    /// When the other state has more or fewer bodies.
    pub fn copy_ground(&mut self, other: &Self) {
        self.ground_height = other.ground_height;
        self.ground_rises.copy_from_slice(&other.ground_rises);
    }

    /// True when every number is finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.ground_height.is_finite()
            && self.ground_rises.iter().all(|rise| rise.is_finite())
            && self.joint_velocities.iter().all(|v| v.is_finite())
            && self.bodies.iter().all(|b| {
                b.position.is_finite()
                    && b.rotation.is_finite()
                    && b.linear_velocity.is_finite()
                    && b.angular_velocity.is_finite()
            })
    }
}

/// Joint angles the motors are to reach, radians, in the order of the skeleton's hinges.
#[derive(Clone, Debug, PartialEq)]
pub struct JointTargets(Vec<f32>);

impl JointTargets {
    /// All zero. Allocates.
    #[must_use]
    pub fn new(skeleton: &Skeleton) -> Self {
        Self(alloc::vec![0.0; skeleton.joint_count()])
    }
}

impl From<Vec<f32>> for JointTargets {
    fn from(radians: Vec<f32>) -> Self {
        Self(radians)
    }
}

impl Deref for JointTargets {
    type Target = [f32];

    fn deref(&self) -> &[f32] {
        &self.0
    }
}

impl DerefMut for JointTargets {
    fn deref_mut(&mut self) -> &mut [f32] {
        &mut self.0
    }
}
