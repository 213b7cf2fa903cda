//! What every physics provides, by the functions of the same names.

use std::sync::Arc;

use policy_core::contract::{PhysicsCharacter, Pose, PoseError, PushError};
use policy_core::glam::Vec3;
use policy_core::{BodyId, CharacterState, Heading, Skeleton};

use super::{Character, Diverged};

impl PhysicsCharacter for Character {
    type Diverged = Diverged;

    fn skeleton(&self) -> &Arc<Skeleton> {
        self.model().skeleton()
    }

    fn control_hz(&self) -> f32 {
        self.model().control_hz()
    }

    fn tick(&self) -> u64 {
        self.tick()
    }

    fn height_at(&self, x: f32, y: f32) -> f32 {
        self.model().height_at(x, y)
    }

    fn stand_at(&mut self, x: f32, y: f32, heading: Heading, speed_mps: f32) -> Result<(), PoseError> {
        self.stand_at(x, y, heading, speed_mps)
    }

    fn set_pose(&mut self, qpos: &[f64], qvel: &[f64]) -> Result<(), PoseError> {
        self.set_pose(qpos, qvel)
    }

    fn pose_into(&self, out: &mut Pose) {
        self.pose_into(out);
    }

    fn sense_into(&self, out: &mut CharacterState) {
        self.sense_into(out);
    }

    fn actuate(&mut self, targets: &[f32]) {
        self.actuate(targets);
    }

    fn step(&mut self) -> Result<(), Diverged> {
        self.step()
    }

    fn push(&mut self, body: BodyId, force: Vec3, secs: f32) -> Result<(), PushError> {
        self.push(body, force, secs)
    }

    fn impulse(&mut self, body: BodyId, impulse: Vec3) -> Result<(), PushError> {
        self.impulse(body, impulse)
    }

    fn is_pushed(&self, body: BodyId) -> bool {
        self.is_pushed(body)
    }
}
