//! A shared world: any number of characters of any models, props, fixtures and joints in one MuJoCo simulation. All of
//! them touch each other; a character touches itself only where its own model says so.

mod accuse;
mod build;
mod carry;
mod contact;
mod control;
mod edit;
mod forces;
mod handle;
mod places;
mod presence;
mod ray;
mod recover;
mod scene;
mod settings;
mod snapshot;
mod solids;
mod stand;
mod step;
#[cfg(test)]
mod tests;

use mujoco_rs::wrappers::mj_data::MjData;
use mujoco_rs::wrappers::mj_model::MjModel;
use policy_core::CharacterState;

use self::accuse::Culprit;
use self::forces::Forces;
use self::places::Places;
use self::recover::Standing;
use self::scene::Scene;
use crate::description::model::Model;
use crate::description::world_error::WorldError;
use crate::ring::Ring;

pub use self::contact::{Part, WorldContact};
pub use self::edit::WorldEdit;
pub use self::forces::{Grab, MAX_GRABS, Movable};
pub use self::handle::{CharacterHandle, FixtureHandle, GrabHandle, Handle, JointHandle, PropHandle};
pub use self::ray::RayHit;
pub use self::recover::{Divergence, Diverging, Remedy};
pub use self::snapshot::{LayoutMismatch, WorldSnapshot};
pub use self::step::{StageTimes, measure_stages};

/// One simulation of any number of characters of any models, props, fixtures and joints. All of them touch each other;
/// a character touches itself only where its own model says so.
///
/// ```
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # const HUMANOID: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/humanoid.xml"));
/// use physics_bridge::{Model, Motion, Prop, World};
/// use policy_core::{Heading, glam::Vec3};
///
/// let model = Model::from_mjcf(HUMANOID)?;
/// let mut world = World::new(&model)?;
/// let (character, crate_) = world.edit(|edit| {
///     let character = edit.add_character(&model, 0.0, 0.0, Heading::FORWARD, 0.0)?;
///     let crate_ = edit.add_prop(Prop::cube(0.4, 5.0), Motion::at(Vec3::new(2.0, 0.0, 0.2)))?;
///     Ok((character, crate_))
/// })?;
/// for _ in 0..30 {
///     assert_eq!(world.step(), 0, "nothing diverges");
/// }
/// assert!(world.motion(crate_)?.position.distance(Vec3::new(2.0, 0.0, 0.2)) < 0.01);
/// world.edit(|edit| edit.remove_prop(crate_))?;
/// assert!(world.motion(crate_).is_err());
/// # let _ = character;
/// # Ok(())
/// # }
/// ```
///
/// # The order of a tick
/// | # | who | what |
/// |---|---|---|
/// | 1 | game | [`World::edit`] adds and removes; [`World::push`], [`World::grab`] and the like act from outside |
/// | 2 | game | [`World::sense_into`] for each character, a controller, [`World::actuate`]; or [`World::control_tick`] for all |
/// | 3 | [`World::step`] | notes the state, to fall back on |
/// | 4 | | every substep: forces from outside, contacts and motion, then all that is derived from the new state |
/// | 5 | | looks for what diverged; puts it back or takes it out, and repeats 3 to 5 for all |
/// | 6 | | notes where each character stands and how high the ground below it is; records the history |
/// | 7 | game | [`World::divergences`], [`World::contacts`], [`World::poses_into`] |
///
/// # What diverges
/// Islands that do not touch each other are solved apart, so one cannot spoil another. A tick with a divergence is
/// repeated from its start. What is well therefore moves as if what diverged had been put back before the tick.
///
/// # What an edit keeps
/// Position, velocity, targets, forces and the start of the solver of everything that stays are kept bit for bit. An
/// edit that adds something builds the simulation anew, which takes milliseconds and grows with the world, so many
/// things are best added in one edit. Props that were reserved, or removed since the last build, come back for nothing.
#[derive(Debug)]
pub struct World {
    ground: Model,
    scene: Scene,
    places: Places,
    data: MjData<Box<MjModel>>,
    tick: u64,
    forces: Forces,
    contacts: Vec<WorldContact>,
    divergences: Vec<Divergence>,
    culprits: Vec<Culprit>,
    /// Told by the next tick.
    waiting: Vec<Divergence>,
    /// Where each character last was well, by index.
    standing: Box<[Standing]>,
    /// What each character senses after the last tick, by index: the ground is found once and read often.
    grounds: Vec<CharacterState>,
    /// What each character sensed in the last control tick, by index.
    sensed: Vec<CharacterState>,
    /// True when the state was changed from outside since the last tick.
    is_touched: bool,
    /// The state before the last tick, to fall back on.
    before: Option<Box<WorldSnapshot>>,
    history: Option<Box<Ring<WorldSnapshot>>>,
}

impl World {
    /// An empty world on the ground of `ground`, with its rates, solver options, gravity and friction. Allocates.
    ///
    /// # Errors
    /// When MuJoCo refuses it.
    pub fn new(ground: &Model) -> Result<Self, WorldError> {
        let scene = Scene::new();
        let built = build::build(ground, &scene)?;
        let data = MjData::new(built.physics);
        let mut world = Self {
            ground: ground.clone(),
            forces: Forces::new(built.places.owners.len()),
            scene,
            places: built.places,
            data,
            tick: 0,
            contacts: Vec::new(),
            divergences: Vec::new(),
            culprits: Vec::new(),
            waiting: Vec::new(),
            standing: Box::default(),
            grounds: Vec::new(),
            sensed: Vec::new(),
            is_touched: false,
            before: None,
            history: None,
        };
        world.make_states();
        world.make_room();
        Ok(world)
    }

    /// The model whose ground and rates it has.
    #[must_use]
    pub fn ground(&self) -> &Model {
        &self.ground
    }

    /// Control ticks completed.
    #[must_use]
    pub fn tick(&self) -> u64 {
        self.tick
    }

    /// The characters, in no order that means anything.
    pub fn characters(&self) -> impl Iterator<Item = CharacterHandle> {
        self.scene.characters.present().map(|(index, _)| self.scene.characters.handle(index))
    }

    /// The props, in no order that means anything.
    pub fn props(&self) -> impl Iterator<Item = PropHandle> {
        self.scene.props.present().map(|(index, _)| self.scene.props.handle(index))
    }

    /// The fixtures, in no order that means anything.
    pub fn fixtures(&self) -> impl Iterator<Item = FixtureHandle> {
        self.scene.fixtures.present().map(|(index, _)| self.scene.fixtures.handle(index))
    }

    /// What touched during the last substep of the last tick.
    #[must_use]
    pub fn contacts(&self) -> &[WorldContact] {
        &self.contacts
    }

    /// What diverged in the last tick, each once.
    #[must_use]
    pub fn divergences(&self) -> &[Divergence] {
        &self.divergences
    }

    /// Allocates what a tick needs, after a build.
    fn make_room(&mut self) {
        let [characters, props] = [self.scene.characters.end(), self.scene.props.end()];
        self.contacts = Vec::with_capacity(contact::most_contacts(&self.scene));
        // What diverged before the build is still to be told.
        self.divergences.reserve(2 * characters + props + 2);
        self.culprits = Vec::with_capacity(characters + props);
        self.waiting.reserve(characters);
        self.before = None;
        self.before = Some(Box::new(WorldSnapshot::empty(self)));
        self.rebuild_history();
    }

    /// Allocates what each character senses, after a build and before characters are placed.
    fn make_states(&mut self) {
        let characters = self.scene.characters.end();
        self.sensed.truncate(characters);
        for index in 0..characters {
            let Some(slot) = self.scene.characters.slot(index) else { continue };
            let skeleton = slot.value.skeleton();
            let state = || CharacterState::new(skeleton);
            self.sensed.resize_with(self.sensed.len().max(index + 1), state);
            if !self.sensed[index].fits(skeleton) {
                self.sensed[index] = state();
            }
        }
        self.grounds.clone_from(&self.sensed);
    }

    /// Computes what is derived from the state.
    fn refresh(&mut self) {
        self.data.step1();
        self.contacts.clear();
        self.note_ground();
    }
}
