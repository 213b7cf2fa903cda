//! One character in the engine of its model.

use std::sync::Arc;

use policy_core::contract::{PhysicsCharacter, Pose, PoseError, PushError};
use policy_core::glam::Vec3;
use policy_core::{BodyId, CharacterState, Heading, Skeleton};

use crate::{Engine, Model, ModelMismatch};

/// One character, alone in its world.
#[derive(Debug)]
pub struct Character {
    model: Model,
    pub(crate) body: Body,
}

#[derive(Debug)]
pub(crate) enum Body {
    Mujoco(Box<physics_bridge::Character>),
    Rapier(Box<physics_rapier::Character>),
}

/// Runs an expression on the character of whichever engine.
macro_rules! either {
    ($self:ident, $character:ident => $run:expr) => {
        match &$self.body {
            Body::Mujoco($character) => $run,
            Body::Rapier($character) => $run,
        }
    };
    (mut $self:ident, $character:ident => $run:expr) => {
        match &mut $self.body {
            Body::Mujoco($character) => $run,
            Body::Rapier($character) => $run,
        }
    };
}

/// The motion of a tick was implausible, and the tick was undone.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Diverged {
    /// In MuJoCo; it can be saved and replayed.
    #[error(transparent)]
    Mujoco(#[from] physics_bridge::Diverged),
    /// In Rapier.
    #[error(transparent)]
    Rapier(#[from] physics_rapier::Diverged),
}

/// The whole state of a character at the end of a tick.
#[derive(Clone, Debug)]
pub struct Snapshot(Saved);

#[derive(Clone, Debug)]
enum Saved {
    Mujoco(physics_bridge::Snapshot),
    Rapier(Box<physics_rapier::Snapshot>),
}

/// The snapshot is of another kind of character.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("expected a snapshot of a character of the same model and engine, found another")]
#[non_exhaustive]
pub struct SnapshotMismatch;

impl Character {
    /// A character that stands at rest at the origin, facing along x. Allocates.
    #[must_use]
    pub fn new(model: &Model) -> Self {
        let body = match model.rapier() {
            None => Body::Mujoco(Box::new(physics_bridge::Character::new(model.described()))),
            Some(rapier) => Body::Rapier(Box::new(physics_rapier::Character::new(rapier))),
        };
        Self { model: model.clone(), body }
    }

    /// The model it was made of.
    #[must_use]
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The engine that it lives in.
    #[must_use]
    pub fn engine(&self) -> Engine {
        self.model.engine()
    }

    /// The state now. Allocates.
    #[must_use]
    pub fn save(&self) -> Snapshot {
        Snapshot(match &self.body {
            Body::Mujoco(character) => Saved::Mujoco(character.save()),
            Body::Rapier(character) => Saved::Rapier(Box::new(character.save())),
        })
    }

    /// Returns to a state; the run continues as it did from there.
    ///
    /// # Errors
    /// When the snapshot is of another kind of character; this one is then unchanged.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<(), SnapshotMismatch> {
        match (&mut self.body, &snapshot.0) {
            (Body::Mujoco(character), Saved::Mujoco(saved)) => {
                character.restore(saved).map_err(|_| SnapshotMismatch)
            }
            (Body::Rapier(character), Saved::Rapier(saved)) => {
                character.restore(saved).map_err(|_| SnapshotMismatch)
            }
            _ => Err(SnapshotMismatch),
        }
    }

    /// Applies another model made of the character's own, from the next step on. In MuJoCo the ground can't change so.
    ///
    /// # Errors
    /// When it is of another character or engine; the character is then unchanged.
    pub fn set_model(&mut self, model: &Model) -> Result<(), ModelMismatch> {
        let set = match (&mut self.body, model.rapier()) {
            (Body::Mujoco(character), None) => character.set_model(model.described()).is_ok(),
            (Body::Rapier(character), Some(rapier)) => character.set_model(rapier).is_ok(),
            _ => false,
        };
        if !set {
            return Err(ModelMismatch);
        }
        self.model = model.clone();
        Ok(())
    }

    /// Height of the lowest point of a body above the ground, metres. Exact on flat ground.
    #[must_use]
    pub fn clearance_of(&self, body: BodyId) -> f32 {
        either!(self, character => character.clearance_of(body))
    }

    /// Vertical force of the ground on a body in the last physics step, newtons. Rapier's is without friction, which on flat
    /// ground has no vertical part.
    #[must_use]
    pub fn ground_load(&self, body: BodyId) -> f32 {
        match &self.body {
            Body::Mujoco(character) => {
                let own = character.contacts().iter().filter(|c| c.body == body && c.other.is_none());
                own.map(|contact| contact.force.z).sum()
            }
            Body::Rapier(character) => character.ground_load(body),
        }
    }

    /// Centre of mass of the whole character, metres, world space.
    #[must_use]
    pub fn centre_of_mass(&self) -> Vec3 {
        either!(self, character => character.centre_of_mass())
    }
}

impl PhysicsCharacter for Character {
    type Diverged = Diverged;

    fn skeleton(&self) -> &Arc<Skeleton> {
        self.model.skeleton()
    }

    fn control_hz(&self) -> f32 {
        self.model.described().control_hz()
    }

    fn tick(&self) -> u64 {
        either!(self, character => character.tick())
    }

    fn height_at(&self, x: f32, y: f32) -> f32 {
        self.model.described().height_at(x, y)
    }

    fn stand_at(&mut self, x: f32, y: f32, heading: Heading, speed_mps: f32) -> Result<(), PoseError> {
        either!(mut self, character => character.stand_at(x, y, heading, speed_mps))
    }

    fn set_pose(&mut self, qpos: &[f64], qvel: &[f64]) -> Result<(), PoseError> {
        either!(mut self, character => character.set_pose(qpos, qvel))
    }

    fn pose_into(&self, out: &mut Pose) {
        either!(self, character => character.pose_into(out));
    }

    fn sense_into(&self, out: &mut CharacterState) {
        either!(self, character => character.sense_into(out));
    }

    fn actuate(&mut self, targets: &[f32]) {
        either!(mut self, character => character.actuate(targets));
    }

    fn step(&mut self) -> Result<(), Diverged> {
        match &mut self.body {
            Body::Mujoco(character) => Ok(character.step()?),
            Body::Rapier(character) => Ok(character.step()?),
        }
    }

    fn push(&mut self, body: BodyId, force: Vec3, secs: f32) -> Result<(), PushError> {
        either!(mut self, character => character.push(body, force, secs))
    }

    fn impulse(&mut self, body: BodyId, impulse: Vec3) -> Result<(), PushError> {
        either!(mut self, character => character.impulse(body, impulse))
    }

    fn is_pushed(&self, body: BodyId) -> bool {
        either!(self, character => character.is_pushed(body))
    }
}
