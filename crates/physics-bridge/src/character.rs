//! The mutable half: one humanoid in its world, and its step.

use std::sync::Arc;

use mujoco_rs::wrappers::mj_data::MjData;
use mujoco_rs::wrappers::mj_model::MjModel;
use policy_core::{Body, Heading};

use crate::contact::{self, Contact, MOST_CONTACTS};
use crate::diverged::{Cause, Diverged, Excess};
use crate::dump::Dump;
use crate::history::History;
use crate::model::Model;
use crate::plausibility::Fault;
use crate::push::Pushes;
use crate::snapshot::Snapshot;

/// One humanoid: [`Character::sense_into`], [`Character::actuate`] and [`Character::step`] each control tick.
///
/// Everything derived from the state, such as positions and velocities of the bodies, is up to date between
/// calls. Allocates about 5 MB when it is made, and nothing when it is stepped.
///
/// ```
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # const HUMANOID: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/humanoid.xml"));
/// use physics_bridge::{Character, Model};
/// use policy_core::{CharacterState, JointTargets};
///
/// let mut character = Character::new(&Model::from_mjcf(HUMANOID)?);
/// let (mut state, targets) = (CharacterState::default(), JointTargets::default());
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
#[derive(Debug)]
pub struct Character {
    pub(crate) model: Model,
    pub(crate) data: MjData<Arc<MjModel>>,
    pub(crate) tick: u64,
    pub(crate) pushes: Pushes,
    pub(crate) contacts: Vec<Contact>,
    pub(crate) history: Option<Box<History>>,
    /// The state before the last tick, to fall back on.
    pub(crate) before: Snapshot,
}

impl Character {
    /// A character that stands at rest at the origin, facing along x. Keeps no history until
    /// [`Character::record_history`] is called.
    #[must_use]
    pub fn new(model: &Model) -> Self {
        let mut character = Self {
            model: model.clone(),
            data: model.new_data(),
            tick: 0,
            pushes: Pushes::default(),
            contacts: Vec::with_capacity(MOST_CONTACTS),
            history: None,
            before: Snapshot::for_model(model),
        };
        character.stand_at(0.0, 0.0, Heading::FORWARD, 0.0).expect("finite numbers, a checked pose");
        character
    }

    /// The model it was made of.
    #[must_use]
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Control ticks completed since the character was posed.
    #[must_use]
    pub fn tick(&self) -> u64 {
        self.tick
    }

    /// Runs one control tick of physics.
    ///
    /// # Errors
    /// When MuJoCo warns of anything, or a body ends the tick beyond a limit of plausible motion
    /// ([`MAX_SPEED_MPS`](crate::MAX_SPEED_MPS) and the others). The character is then back in its state before
    /// the tick, and the error carries that state, to be saved and replayed.
    pub fn step(&mut self) -> Result<(), Diverged> {
        self.before.record(&self.data, self.tick, &self.pushes);
        let substeps = self.model.substeps();
        for substep in 0..substeps {
            self.pushes.apply(&mut self.data, self.model.layout());
            // The two halves of `mj_step`, turned round, so that everything derived from the state is up to
            // date when the tick ends.
            self.data.step2();
            if substep + 1 == substeps {
                contact::collect(&self.data, self.model.layout(), &mut self.contacts);
            }
            self.data.step1();
            if let Some(index) = self.data.warning().iter().position(|w| w.number > 0) {
                let cause = Cause::WARNINGS[index];
                let place = usize::try_from(self.data.warning()[index].lastinfo).ok();
                let body = place.and_then(|place| self.model.layout().body_of(cause, place));
                return Err(self.diverge(substep, cause, body, None));
            }
        }
        if let Some(Fault { cause, body, excess }) = self.fault() {
            return Err(self.diverge(substeps - 1, cause, Some(body), Some(excess)));
        }
        self.tick += 1;
        if let Some(history) = &mut self.history {
            history.next_slot().record(&self.data, self.tick, &self.pushes);
        }
        Ok(())
    }

    /// Computes what is derived from the state.
    pub(crate) fn refresh(&mut self) {
        self.data.step1();
        self.contacts.clear();
    }

    /// Returns to the state before the tick.
    fn diverge(
        &mut self,
        substep: u32,
        cause: Cause,
        body: Option<Body>,
        excess: Option<Excess>,
    ) -> Diverged {
        let before = self.before.clone();
        self.take_up(&before);
        let dump = Box::new(Dump::new(&self.model, before));
        Diverged { tick: self.tick, substep, cause, body, excess, dump }
    }
}
