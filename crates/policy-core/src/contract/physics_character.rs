//! One character in a physics, whatever the engine.

use alloc::sync::Arc;

use glam::Vec3;

use super::{Pose, PoseError, PushError};
use crate::heading::Heading;
use crate::ids::BodyId;
use crate::skeleton::Skeleton;
use crate::state::CharacterState;

/// One character in a physics: what measures, demos and tests need of an engine. The crates of this project implement it;
/// a game with a physics of its own needs none of it.
///
/// SI units, radians, world space with z up.
pub trait PhysicsCharacter {
    /// Why a tick was undone.
    type Diverged: core::error::Error + Send + 'static;

    /// Bodies, hinges and roles.
    fn skeleton(&self) -> &Arc<Skeleton>;

    /// Control ticks per second.
    fn control_hz(&self) -> f32;

    /// Control ticks completed since the character was posed.
    fn tick(&self) -> u64;

    /// Height of the ground at a point, metres.
    fn height_at(&self, x: f32, y: f32) -> f32;

    /// Stands the character on the ground at a point, metres, facing along `heading` and moving along it at `speed_mps`.
    ///
    /// # Errors
    /// When a number is not finite; the character is then unchanged.
    fn stand_at(&mut self, x: f32, y: f32, heading: Heading, speed_mps: f32) -> Result<(), PoseError>;

    /// Puts the character into any position and velocity, laid out as in [`Pose`], and forgets everything else.
    ///
    /// # Errors
    /// When the numbers are no pose of this character; it is then unchanged.
    fn set_pose(&mut self, qpos: &[f64], qvel: &[f64]) -> Result<(), PoseError>;

    /// Writes position and velocity.
    fn pose_into(&self, out: &mut Pose);

    /// Writes what a policy senses.
    fn sense_into(&self, out: &mut CharacterState);

    /// Sets the angles that the motors pull the joints to, radians, in the order of the skeleton.
    fn actuate(&mut self, targets: &[f32]);

    /// Runs one control tick of physics.
    ///
    /// # Errors
    /// When the motion is implausible; the character is then as before the tick.
    fn step(&mut self) -> Result<(), Self::Diverged>;

    /// Pushes `body` at its centre of mass with `force` newtons, world axes, for `secs` from now. While the body already moves
    /// along the force at [`MAX_PUSHED_MPS`](super::MAX_PUSHED_MPS), the force is zero.
    ///
    /// # Errors
    /// When there is no such body, or a number is out of its range.
    fn push(&mut self, body: BodyId, force: Vec3, secs: f32) -> Result<(), PushError>;

    /// Hits `body` at its centre of mass with `impulse` newton seconds, world axes. An impulse on a body that already moves along
    /// it at [`MAX_PUSHED_MPS`](super::MAX_PUSHED_MPS) has no effect.
    ///
    /// # Errors
    /// When there is no such body, or the impulse is out of its range.
    fn impulse(&mut self, body: BodyId, impulse: Vec3) -> Result<(), PushError>;

    /// True while a push acts on `body`, or an impulse waits for the next physics step.
    fn is_pushed(&self, body: BodyId) -> bool;

    /// Position and velocity now. Allocates.
    fn pose(&self) -> Pose {
        let mut pose = Pose::new(self.skeleton());
        self.pose_into(&mut pose);
        pose
    }
}
