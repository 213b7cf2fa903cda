//! One character alone on the ground of its MJCF, in a world of its own.

mod diverged;
mod ground;
mod physics_character;
pub(crate) mod push;
mod save;

use policy_core::contract::{Pose, PoseError};
use policy_core::glam::Vec3;
use policy_core::{BodyId, CharacterState, Command, Controller, Heading};
use rapier3d::pipeline::PhysicsWorld;

use crate::articulation::pose::check_pose;
use crate::articulation::{Articulation, Drive, PlaceError, Sets};
use crate::model::Model;

pub(crate) use self::ground::empty_world;
use self::ground::{motor_steps, world};
use self::push::Pushes;

pub use self::diverged::{Cause, Diverged};
pub use self::save::{ModelMismatch, Snapshot, SnapshotMismatch};

/// Why a whole character can't lose a part here: its world is only read from outside.
const WHOLE: &str = "the parts of a character stay in its own world";

/// One character. Each control tick calls [`Character::sense_into`], [`Character::actuate`] and
/// [`Character::step`], or [`Character::control_tick`] for all of them.
///
/// The world has the geoms of the MJCF's world and nothing else. For props, terrain and other characters put an
/// [`Articulation`] into a world of your own.
///
/// ```
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # const HUMANOID: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/humanoid.xml"));
/// use physics_rapier::{Character, Model};
/// use policy_core::{CharacterState, JointTargets};
///
/// let model = Model::from_mjcf(HUMANOID)?;
/// let mut character = Character::new(&model);
/// let mut state = CharacterState::new(model.skeleton());
/// let targets = JointTargets::new(model.skeleton());
/// for _ in 0..3 {
///     character.sense_into(&mut state);
///     // a controller makes targets of the state here
///     character.actuate(&targets);
///     character.step()?;
/// }
/// assert_eq!(character.tick(), 3);
/// # Ok(())
/// # }
/// ```
pub struct Character {
    world: PhysicsWorld,
    articulation: Articulation,
    steps: u32,
    tick: u64,
    pushes: Pushes,
    /// The state before the last tick, to fall back on.
    before: Pose,
    /// What was sensed at the start of the last [`Character::control_tick`].
    sensed: CharacterState,
    /// What the last step ended in, to check it.
    after: CharacterState,
}

impl Character {
    /// A character that stands at rest at the origin, facing along x, driven by [`Drive::Torques`]. Allocates.
    #[must_use]
    pub fn new(model: &Model) -> Self {
        Self::with_drive(model, Drive::Torques)
    }

    /// The same with another drive. [`Drive::Torques`] steps at the model's physics rate with one substep,
    /// [`Drive::Motors`] at 60 Hz with two.
    #[must_use]
    pub fn with_drive(model: &Model, drive: Drive) -> Self {
        let (world, articulation) = world(model, drive);
        let steps = match drive {
            Drive::Torques => model.substeps(),
            Drive::Motors => motor_steps(model),
        };
        let mut character = Self {
            world,
            articulation,
            steps,
            tick: 0,
            pushes: Pushes::new(model.skeleton()),
            before: Pose::new(model.skeleton()),
            sensed: CharacterState::new(model.skeleton()),
            after: CharacterState::new(model.skeleton()),
        };
        character.stand_at(0.0, 0.0, Heading::FORWARD, 0.0).expect("finite numbers, a checked pose");
        character
    }

    /// The model it was made of.
    #[must_use]
    pub fn model(&self) -> &Model {
        self.articulation.model()
    }

    /// The world, to draw it or to look for contacts.
    #[must_use]
    pub fn world(&self) -> &PhysicsWorld {
        &self.world
    }

    /// The character in it.
    #[must_use]
    pub fn articulation(&self) -> &Articulation {
        &self.articulation
    }

    /// Control ticks completed since the character was posed.
    #[must_use]
    pub fn tick(&self) -> u64 {
        self.tick
    }

    /// Writes what a policy senses. Allocates only when `out` was made for another skeleton.
    pub fn sense_into(&self, out: &mut CharacterState) {
        sense_into(&self.world, &self.articulation, out);
    }

    /// Sets the angles that the motors pull the joints to, radians, in the order of the skeleton. They hold until
    /// the next call. Joints without a finite target keep theirs; targets without a joint are ignored.
    pub fn actuate(&mut self, targets: &[f32]) {
        self.articulation.actuate(targets);
    }

    /// Runs one control tick of physics. Allocates nothing but what Rapier does.
    ///
    /// # Errors
    /// When a body ends the tick beyond a limit of plausible motion ([`MAX_SPEED_MPS`](crate::MAX_SPEED_MPS) and the others). The
    /// character is then back in its pose before the tick, and a caller must reset it or it diverges again.
    pub fn step(&mut self) -> Result<(), Diverged> {
        let (world, articulation) = (&mut self.world, &mut self.articulation);
        articulation.pose_into(&world.bodies, &world.multibody_joints, &mut self.before).expect(WHOLE);
        for _ in 0..self.steps {
            articulation.before_step(&mut world.bodies, &mut world.multibody_joints).expect(WHOLE);
            if self.pushes.are_under_way() {
                sense_into(world, articulation, &mut self.after);
                let (bodies, dt_secs) = (&mut world.bodies, world.integration_parameters.dt);
                self.pushes.apply(bodies, articulation.bodies(), &self.after, dt_secs);
            }
            world.step();
        }
        sense_into(world, articulation, &mut self.after);
        if let Err(diverged) = Diverged::check(articulation.model().skeleton(), &self.after, self.tick) {
            let targets = articulation.targets().to_vec();
            let before = self.before.clone();
            self.restart(&before.qpos, &before.qvel);
            self.articulation.actuate(&targets);
            return Err(diverged);
        }
        self.tick += 1;
        Ok(())
    }

    /// Runs one control tick: senses the character, lets `controller` make joint targets of the state and of
    /// `command`, and steps the physics. `dt_secs` is the control period, usually 1 over [`Model::control_hz`].
    ///
    /// # Errors
    /// As [`Character::step`]. The controller has then completed its tick and the character has not.
    pub fn control_tick(
        &mut self,
        controller: &mut Controller,
        command: &Command,
        dt_secs: f32,
    ) -> Result<(), Diverged> {
        sense_into(&self.world, &self.articulation, &mut self.sensed);
        let targets = controller.tick(&self.sensed, command, dt_secs);
        self.articulation.actuate(targets);
        self.step()
    }

    /// What the character sensed at the start of the last control tick; zero before the first.
    #[must_use]
    pub fn sensed(&self) -> &CharacterState {
        &self.sensed
    }

    /// Puts the character into any position and velocity, laid out as in [`Pose`], and forgets everything else:
    /// time, targets, pushes, contacts. The motors hold the pose until [`Character::actuate`] is called. Builds the
    /// world anew, so equal poses have equal futures. Allocates.
    ///
    /// # Errors
    /// When there are more or fewer numbers than the character has, a number is not finite in single precision or the
    /// quaternion is no rotation; the character is then unchanged.
    pub fn set_pose(&mut self, qpos: &[f64], qvel: &[f64]) -> Result<(), PoseError> {
        check_pose(qpos, qvel, self.model().skeleton().joint_count())?;
        self.restart(qpos, qvel);
        self.tick = 0;
        self.pushes.clear();
        Ok(())
    }

    /// Stands the character on the ground at a point, metres, world space, facing along `heading`, its lowest
    /// point touching the ground. All of it moves along `heading` at `speed_mps`: 0 for a policy that stands,
    /// [`WALKING_START_MPS`](crate::WALKING_START_MPS) for one that only walks and would fall from a standstill. Allocates.
    ///
    /// # Errors
    /// When a number is not finite; the character is then unchanged.
    pub fn stand_at(&mut self, x: f32, y: f32, heading: Heading, speed_mps: f32) -> Result<(), PoseError> {
        let point = [x, y, self.model().height_at(x, y)];
        match self.articulation.stand_at(&mut Sets::from(&mut self.world), point, heading, speed_mps) {
            Ok(()) => {}
            Err(PlaceError::Pose(error)) => return Err(error),
            Err(PlaceError::Removed(_)) => unreachable!("{WHOLE}"),
        }
        let Pose { qpos, qvel } = self.pose();
        self.set_pose(&qpos, &qvel)
    }

    /// Position and velocity now. Allocates; see [`Character::pose_into`].
    #[must_use]
    pub fn pose(&self) -> Pose {
        let mut pose = Pose::new(self.model().skeleton());
        self.pose_into(&mut pose);
        pose
    }

    /// Writes position and velocity. Allocates only when `out` was made for another skeleton.
    pub fn pose_into(&self, out: &mut Pose) {
        self.articulation.pose_into(&self.world.bodies, &self.world.multibody_joints, out).expect(WHOLE);
    }

    /// Centre of mass of the whole character, metres, world space.
    #[must_use]
    pub fn centre_of_mass(&self) -> Vec3 {
        let bodies = self.articulation.bodies().iter().map(|&body| &self.world.bodies[body]);
        let (sum, mass) = bodies.fold((Vec3::ZERO, 0.0), |(sum, mass), body| {
            let centre = *body.position() * body.mass_properties().local_mprops.local_com;
            (sum + body.mass() * centre, mass + body.mass())
        });
        sum / mass
    }

    /// True while a push acts on `body`, or an impulse waits for the next physics step.
    #[must_use]
    pub fn is_pushed(&self, body: BodyId) -> bool {
        self.pushes.acts_on(body)
    }

    /// A new world with the character in this pose.
    fn restart(&mut self, qpos: &[f64], qvel: &[f64]) {
        let model = self.model().clone();
        self.restart_as(&model, qpos, qvel);
    }

    /// The same, of another model of its body.
    fn restart_as(&mut self, model: &Model, qpos: &[f64], qvel: &[f64]) {
        let (world, articulation) = world(model, self.articulation.drive());
        (self.world, self.articulation) = (world, articulation);
        self.articulation
            .set_pose(&mut Sets::from(&mut self.world), qpos, qvel)
            .expect("a checked pose, or one of this character");
    }
}

impl std::fmt::Debug for Character {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Character").field("tick", &self.tick).finish_non_exhaustive()
    }
}

pub(crate) fn sense_into(world: &PhysicsWorld, articulation: &Articulation, out: &mut CharacterState) {
    articulation.sense_into(&world.bodies, &world.multibody_joints, 0.0, out).expect(WHOLE);
    let model = articulation.model();
    out.sense_ground(model.skeleton(), |at| model.height_at(at.x, at.y));
}
