//! Starts where an episodic skill hands over: dropped limp, raised by the skill as in a game.

use policy_core::{Command as GameCommand, Controller, SkillEnd};

use super::super::command::{Command, DT_SECS};
use super::super::population::Stage;
use super::Agent;

/// Ticks that a rise may take; one that takes longer starts nothing.
const RISE_TICKS: u32 = 180;

/// An episodic skill that raises a character, and where on the course it hands over.
#[derive(Clone, Debug)]
pub struct Recovery {
    /// A controller of a pack with the skill; it recovers nobody by itself.
    pub controller: Controller,
    /// Index of the skill in that pack.
    pub skill: usize,
    /// Node of the course that the skill returns to.
    pub node: usize,
}

impl Agent {
    /// Starts an episode at the tick in which the skill hands over, at the node it returns to; false when the stage has no such
    /// skill or it did not come to that.
    pub(super) fn start_risen(&mut self, stage: &Stage<'_>) -> bool {
        let Some(recovery) = stage.recovery else { return false };
        let pose = stage.demonstrations[recovery.node].draw_start(&mut self.rng);
        self.drop_limp(stage, &pose);
        let mut controller = recovery.controller.clone();
        controller.reset();
        let mut asked = GameCommand { skill: Some(recovery.skill), ..GameCommand::default() };
        for _ in 0..RISE_TICKS {
            let targets = *controller.tick(&self.state, &asked, DT_SECS);
            asked.skill = None;
            match controller.report().skill_ended {
                Some((_, SkillEnd::Recognised)) => {
                    self.imitated = None;
                    self.command =
                        Command::start_at(stage.config, stage.course, recovery.node, &mut self.rng);
                    let at = (self.position(), self.heading().angle());
                    self.command.aim(stage.config, stage.course, at, &mut self.rng);
                    return true;
                }
                Some(_) => return false,
                None => {}
            }
            self.character.actuate(&targets);
            if self.character.step().is_err() {
                return false;
            }
            self.character.sense_into(&mut self.state);
            self.push_frame(stage);
        }
        false
    }
}
