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

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::sync::Arc;

    use physics_bridge::Model;
    use policy_core::{Body, CharacterPack, ControllerConfig};

    use super::super::super::config::EnvironmentConfig;
    use super::super::super::course::{Course, CourseNode};
    use super::super::super::demonstrations::Demonstrations;
    use super::super::super::normalisers::Normalisers;
    use super::*;
    use crate::Rng;
    use crate::clip::tests::still;

    #[test]
    fn the_skill_that_ships_hands_over_somebody_who_is_up() {
        let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets");
        let model = Model::load(assets.join("humanoid.xml")).unwrap();
        let pack = std::fs::read(assets.join("humanoid.pack.safetensors")).unwrap();
        let pack = Arc::new(CharacterPack::from_bytes(&pack).unwrap());
        let normalisers = Normalisers {
            observation: pack.tensors().observation_normaliser.clone(),
            frame: pack.tensors().discriminator_normaliser.clone(),
        };
        let clips =
            Demonstrations::from_clips(&[(still(30), 1.0, false)], &model, &normalisers.frame).unwrap();
        let config = EnvironmentConfig::default();
        let nodes = ["walk", "idle"].map(|name| CourseNode::new(name, &config, 1.0)).to_vec();
        let course = Course::new(nodes, vec![vec![1, 0]]);
        let recovery = Recovery {
            skill: pack.skill_named("get_up").unwrap(),
            controller: Controller::with_config(
                pack,
                ControllerConfig { recover: false, ..Default::default() },
            ),
            node: 1,
        };
        let stage = Stage {
            config: &config,
            course: &course,
            demonstrations: &[&clips, &clips],
            start_demonstrations: None,
            recovery: Some(&recovery),
            normalisers: &normalisers,
        };
        let mut agent = Agent::new(&model, Rng::new(7, 0));
        let mut up = 0;
        for _ in 0..8 {
            if agent.start_risen(&stage) {
                assert!(agent.state.height_of(Body::Pelvis) > 0.7 && !agent.imitates());
                assert_eq!(course.node_at(agent.command.place), Some(1));
                up += 1;
            }
        }
        assert!(up >= 6, "{up} of 8");
        assert!(!agent.start_risen(&Stage { recovery: None, ..stage }));
    }
}
