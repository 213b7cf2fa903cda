//! Sense, control, actuate, step: the whole control tick of one character.

use policy_core::{CharacterState, Command, Controller};

use super::{Character, Diverged};
use crate::kinematics::sense_into;

impl Character {
    /// Runs one control tick: senses the character, lets `controller` make joint targets of the state and of
    /// `command`, and steps the physics. `dt_secs` is the control period, usually 1 over
    /// [`Model::control_hz`](crate::Model::control_hz). Does not allocate.
    ///
    /// A controller for another skeleton sets [`TickReport::fault`](policy_core::TickReport::fault).
    ///
    /// # Errors
    /// As [`Character::step`]. The controller has then completed its tick and the character has not.
    pub fn control_tick(
        &mut self,
        controller: &mut Controller,
        command: &Command,
        dt_secs: f32,
    ) -> Result<(), Diverged> {
        self.sense();
        let targets = controller.tick(&self.sensed, command, dt_secs);
        self.actuate(targets);
        self.step()
    }

    /// What the character sensed at the start of the last control tick; zero before the first.
    #[must_use]
    pub fn sensed(&self) -> &CharacterState {
        &self.sensed
    }

    /// Updates [`Character::sensed`].
    pub(crate) fn sense(&mut self) {
        let model = &self.model;
        sense_into(&self.data, model.layout(), &mut self.sensed);
        self.sensed.sense_ground(model.skeleton(), |at| model.height_at(at.x, at.y));
    }
}
