//! The mutable half: one character in its world, and its step.

mod contact;
mod control;
mod diverged;
mod history;
mod physics_character;
mod plausibility;
mod push;
mod replay_file;
mod reset;
mod sense;
mod snapshot;

use std::sync::Arc;

use mujoco_rs::wrappers::mj_data::MjData;
use mujoco_rs::wrappers::mj_model::MjModel;
use policy_core::{BodyId, CharacterState, Heading};

use self::history::History;
use self::plausibility::Fault;
use self::push::Pushes;
use crate::cause::{Cause, Excess};
use crate::description::model::Model;

pub use self::contact::Contact;
pub use self::diverged::Diverged;
pub use self::history::HISTORY_SECS;
pub use self::replay_file::{ReplayFile, ReplayFileError};
pub use self::reset::ModelMismatch;
pub use self::snapshot::{Snapshot, SnapshotMismatch, StateHash};

/// One character. Each control tick calls [`Character::sense_into`], [`Character::actuate`] and
/// [`Character::step`], or [`Character::control_tick`] for all of them.
///
/// Everything derived from the state, such as positions and velocities of the bodies, is up to date between
/// calls. Allocates when it is made, about 5 MB for the humanoid, and nothing when it is stepped.
///
/// ```
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # const HUMANOID: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/humanoid.xml"));
/// use physics_bridge::{Character, Model};
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
#[derive(Debug)]
pub struct Character {
    model: Model,
    data: MjData<Arc<MjModel>>,
    tick: u64,
    pushes: Pushes,
    contacts: Vec<Contact>,
    history: Option<Box<History>>,
    /// The state before the last tick, to fall back on.
    before: Snapshot,
    /// What was sensed at the start of the last [`Character::control_tick`].
    sensed: CharacterState,
}

impl Character {
    /// A character that stands at rest at the origin, facing along x. Keeps no history until
    /// [`Character::record_history`] is called. Allocates.
    #[must_use]
    pub fn new(model: &Model) -> Self {
        let mut character = Self {
            model: model.clone(),
            data: model.new_data(),
            tick: 0,
            pushes: Pushes::new(model.skeleton()),
            contacts: Vec::with_capacity(contact::most_contacts(model.skeleton())),
            history: None,
            before: Snapshot::for_model(model),
            sensed: CharacterState::new(model.skeleton()),
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
    /// ([`MAX_SPEED_MPS`](crate::MAX_SPEED_MPS) and the others). The character is then back in its state before the tick, and the error
    /// carries that state, to be saved and replayed.
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
                let body = place.and_then(|place| cause.body(self.model.layout(), place));
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
    fn refresh(&mut self) {
        self.data.step1();
        self.contacts.clear();
    }

    /// Returns to the state before the tick.
    fn diverge(
        &mut self,
        substep: u32,
        cause: Cause,
        body: Option<BodyId>,
        excess: Option<Excess>,
    ) -> Diverged {
        let before = self.before.clone();
        self.load_state(&before);
        let replay = Box::new(ReplayFile::new(&self.model, before));
        Diverged { tick: self.tick, substep, cause, body, excess, replay }
    }
}
