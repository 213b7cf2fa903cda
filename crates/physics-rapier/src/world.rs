//! Several characters, props and fixtures in one world: they touch each other.
//!
//! Its characters are driven by [`Drive::Torques`] at the physics rate of their model. It decides nothing: who plays
//! puts back what diverged.

mod fixture;
mod joint;
mod prop;
mod save;
mod shape;

use policy_core::contract::{Pose, PoseError, PushError, Solid};
use policy_core::glam::Vec3;
use policy_core::{BodyId, CharacterState, Heading};
use rapier3d::dynamics::RigidBodyHandle;
use rapier3d::geometry::InteractionGroups;
use rapier3d::math::Pose as Place;
use rapier3d::pipeline::PhysicsWorld;

use crate::articulation::{Articulation, Drive, PlaceError, Sets};
use crate::character::push::Pushes;
use crate::character::{Diverged, empty_world, sense_into};
use crate::model::Model;

use self::fixture::Standing;
pub use self::save::{WorldError, WorldSnapshot};
pub(crate) use self::shape::of_heights;

/// Most characters, props, fixtures or joints.
const MOST: usize = 256;

/// Why a character can't lose a part here: the sets are only read from outside.
const WHOLE: &str = "the parts of a character stay in its world";

/// Characters of one model, props and fixtures on the ground of that model. Characters and props have indices in the order in
/// which they were added; nothing is taken out.
///
/// ```
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # const HUMANOID: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/humanoid.xml"));
/// use physics_rapier::{Model, Motion, Prop, World};
/// use policy_core::{Heading, glam::Vec3};
///
/// let mut world = World::new(&Model::from_mjcf(HUMANOID)?);
/// let one = world.add_character()?;
/// let other = world.add_character()?;
/// world.stand_at(other, 2.0, 0.0, Heading::from_angle(3.1), 0.0)?;
/// world.add_prop(&Prop::cube(0.4, 5.0), &Motion::at(Vec3::new(1.0, 1.0, 0.2)))?;
/// let before = world.save();
/// world.step();
/// world.restore(&before)?;
/// assert_eq!((world.tick(), one), (0, 0));
/// # Ok(())
/// # }
/// ```
pub struct World {
    model: Model,
    world: PhysicsWorld,
    residents: Vec<Resident>,
    props: Vec<PropBody>,
    fixtures: Vec<Standing>,
    /// The fixed body that holds what is joined to the world.
    pillar: Option<RigidBodyHandle>,
    /// Joints of props. Characters have joints of their own.
    joints: usize,
    tick: u64,
    /// What was sensed of a pushed character.
    sensed: CharacterState,
}

/// A character in the world.
#[derive(Clone)]
struct Resident {
    articulation: Articulation,
    pushes: Pushes,
}

/// A prop in the world, and where it began.
#[derive(Clone)]
struct PropBody {
    body: RigidBodyHandle,
    solid: Solid,
    start: Place,
    /// How far it reaches from the origin of its body, metres.
    reach: f32,
}

impl World {
    /// A world of the model's ground without anything on it. Allocates.
    #[must_use]
    pub fn new(model: &Model) -> Self {
        Self {
            world: empty_world(model, Drive::Torques),
            sensed: CharacterState::new(model.skeleton()),
            model: model.clone(),
            residents: Vec::new(),
            props: Vec::new(),
            fixtures: Vec::new(),
            pillar: None,
            joints: 0,
            tick: 0,
        }
    }

    /// Adds a character that stands at the origin, and returns its index. Allocates.
    ///
    /// # Errors
    /// When the world has as many as it may have.
    pub fn add_character(&mut self) -> Result<usize, WorldError> {
        if self.residents.len() >= MOST {
            return Err(WorldError::Full { what: "characters", most: MOST });
        }
        let mut sets = Sets::from(&mut self.world);
        let articulation =
            Articulation::insert(&self.model, &mut sets, Drive::Torques, InteractionGroups::all());
        self.residents.push(Resident { articulation, pushes: Pushes::new(self.model.skeleton()) });
        let index = self.residents.len() - 1;
        self.stand_at(index, 0.0, 0.0, Heading::FORWARD, 0.0)?;
        Ok(index)
    }

    /// The model of its characters.
    #[must_use]
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Characters in it.
    #[must_use]
    pub fn character_count(&self) -> usize {
        self.residents.len()
    }

    /// Control ticks completed.
    #[must_use]
    pub fn tick(&self) -> u64 {
        self.tick
    }

    /// Rapier's world, to draw it or to look for contacts.
    #[must_use]
    pub fn world(&self) -> &PhysicsWorld {
        &self.world
    }

    /// Stands a character on the ground at a point, metres, its lowest point touching the ground. All of it moves along
    /// `heading` at `speed_mps`. Its pushes end. Allocates.
    ///
    /// # Errors
    /// When a number is not finite or there is no such character; nothing is changed then.
    pub fn stand_at(
        &mut self,
        character: usize,
        x: f32,
        y: f32,
        heading: Heading,
        speed_mps: f32,
    ) -> Result<(), WorldError> {
        let point = [x, y, self.model.height_at(x, y)];
        let resident = resident_mut(&mut self.residents, character)?;
        let mut sets = Sets::from(&mut self.world);
        placed(resident.articulation.stand_at(&mut sets, point, heading, speed_mps))?;
        resident.pushes.clear();
        Ok(())
    }

    /// Writes what a policy senses of a character. The ground is what is highest below the height of its
    /// root, and a prop that it can step onto. Allocates only when `out` was made for another skeleton.
    ///
    /// # Errors
    /// When there is no such character.
    pub fn sense_into(&self, character: usize, out: &mut CharacterState) -> Result<(), WorldError> {
        sense_into(&self.world, &self.resident(character)?.articulation, out);
        let skeleton = self.model.skeleton();
        let (z, top) = (out.root().position.z, out.step_top(skeleton));
        out.sense_ground(skeleton, |at| self.footing_below(at.extend(z), top));
        Ok(())
    }

    /// Writes position and velocity of a character. Allocates only when `out` was made for another skeleton.
    ///
    /// # Errors
    /// When there is no such character.
    pub fn pose_into(&self, character: usize, out: &mut Pose) -> Result<(), WorldError> {
        let world = &self.world;
        let articulation = &self.resident(character)?.articulation;
        articulation.pose_into(&world.bodies, &world.multibody_joints, out).expect(WHOLE);
        Ok(())
    }

    /// Sets the angles that the motors of a character pull to, radians, as
    /// [`Character::actuate`](crate::Character::actuate).
    ///
    /// # Errors
    /// When there is no such character.
    pub fn actuate(&mut self, character: usize, targets: &[f32]) -> Result<(), WorldError> {
        resident_mut(&mut self.residents, character)?.articulation.actuate(targets);
        Ok(())
    }

    /// Pushes a body of a character as [`Character::push`](crate::Character::push).
    ///
    /// # Errors
    /// When there is no such character or body, or the push is out of its bounds.
    pub fn push(&mut self, character: usize, body: BodyId, force: Vec3, secs: f32) -> Result<(), WorldError> {
        let dt_secs = self.world.integration_parameters.dt;
        Ok(resident_mut(&mut self.residents, character)?.pushes.push(body, force, secs, dt_secs)?)
    }

    /// True while a push acts on a body of a character.
    #[must_use]
    pub fn is_pushed(&self, character: usize, body: BodyId) -> bool {
        self.residents.get(character).is_some_and(|resident| resident.pushes.acts_on(body))
    }

    /// Runs one control tick of physics. Allocates nothing but what Rapier does. Whether a character moves plausibly
    /// afterwards is said by [`World::check`].
    pub fn step(&mut self) {
        let world = &mut self.world;
        for _ in 0..self.model.substeps() {
            for Resident { articulation, pushes } in &mut self.residents {
                articulation.before_step(&mut world.bodies, &mut world.multibody_joints).expect(WHOLE);
                if pushes.are_under_way() {
                    sense_into(world, articulation, &mut self.sensed);
                    let dt_secs = world.integration_parameters.dt;
                    pushes.apply(&mut world.bodies, articulation.bodies(), &self.sensed, dt_secs);
                }
            }
            world.step();
        }
        self.tick += 1;
    }

    /// Checks the motion of a character, as [`Character::step`](crate::Character::step) does. `state` is what
    /// [`World::sense_into`] wrote for it.
    ///
    /// # Errors
    /// When it is implausible. The character has to be stood somewhere, or it diverges again.
    pub fn check(&self, state: &CharacterState) -> Result<(), Diverged> {
        Diverged::check(self.model.skeleton(), state, self.tick)
    }

    fn resident(&self, character: usize) -> Result<&Resident, WorldError> {
        let found = self.residents.len();
        self.residents.get(character).ok_or(WorldError::Missing {
            what: "character",
            index: character,
            found,
        })
    }
}

fn resident_mut(residents: &mut [Resident], character: usize) -> Result<&mut Resident, WorldError> {
    let found = residents.len();
    residents.get_mut(character).ok_or(WorldError::Missing { what: "character", index: character, found })
}

fn placed(result: Result<(), PlaceError>) -> Result<(), PoseError> {
    match result {
        Ok(()) => Ok(()),
        Err(PlaceError::Pose(error)) => Err(error),
        Err(PlaceError::Removed(_)) => unreachable!("{WHOLE}"),
    }
}

impl From<PushError> for WorldError {
    fn from(error: PushError) -> Self {
        Self::Push(error)
    }
}

impl std::fmt::Debug for World {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut out = f.debug_struct("World");
        out.field("tick", &self.tick).field("characters", &self.residents.len());
        out.field("props", &self.props.len()).finish_non_exhaustive()
    }
}
