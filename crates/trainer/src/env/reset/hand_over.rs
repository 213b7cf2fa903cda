//! Starts where an episodic skill hands over, as in a game: the character is dropped limp, or in a gait, and the skill plays.

use policy_core::training::{RISE_SECONDS, TARGET_RANGE_METRES};
use policy_core::{Command as GameCommand, Controller, SkillEnd, SkillId};

use super::super::command::{Command, DT_SECS};
use super::super::env::{Env, EnvContext};

/// Ticks that the skill may take, twice what a game gives a rise; after that the start is given up.
const RISE_TICKS: u32 = (2.0 * RISE_SECONDS / DT_SECS) as u32;

/// An episodic skill, what it starts from, and where on the graph it hands over.
#[derive(Clone, Debug)]
pub struct HandOver {
    /// A controller of a pack with the skill, without automatic recovery.
    pub controller: Controller,
    /// The skill in that pack.
    pub skill: SkillId,
    /// Node of the graph that the skill returns to.
    pub node: usize,
    /// Nodes in whose clips the skill starts; dropped limp when there are none.
    pub out_of: Vec<usize>,
}

impl Env {
    /// Starts an episode at the tick in which the skill hands over to its node; false when it did not succeed.
    pub(in super::super) fn start_at_hand_over(
        &mut self,
        context: &EnvContext<'_>,
        hand_over: &HandOver,
    ) -> bool {
        let out_of = match hand_over.out_of.as_slice() {
            [] => None,
            nodes => Some(nodes[self.rng.index(nodes.len())]),
        };
        let demonstrations = context.demonstrations[out_of.unwrap_or(hand_over.node)];
        let start = demonstrations.sample_reference_state(&mut self.rng);
        match out_of {
            None => self.drop_limp(context, &start),
            Some(_) => self.start_from(&start),
        }
        let mut controller = hand_over.controller.clone();
        controller.reset();
        let target = out_of.map(|_| self.root_position() + TARGET_RANGE_METRES * self.heading().direction());
        let mut asked = GameCommand { skill: Some(hand_over.skill), target, ..GameCommand::default() };
        for _ in 0..RISE_TICKS {
            controller.tick(&self.state, &asked, DT_SECS);
            asked.skill = None;
            match controller.report().skill_ended {
                Some((_, SkillEnd::Recognised)) => {
                    self.tracking = None;
                    self.command = Command::start_at(
                        &context.config.command,
                        context.graph,
                        hand_over.node,
                        &mut self.rng,
                    );
                    self.aim(context);
                    return true;
                }
                Some(_) => return false,
                None => {}
            }
            if !self.step_before(context, controller.joint_targets()) {
                return false;
            }
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use policy_core::{ControllerConfig, NodeId};

    use super::super::super::config::EnvironmentConfig;
    use super::super::super::demonstrations::Demonstrations;
    use super::super::super::graph::{GraphNode, TrainingGraph};
    use super::super::super::made_up::{Setting, shipped, still};
    use super::*;
    use random::Rng;

    #[test]
    fn the_shipped_skill_hands_over_a_character_that_stands() {
        let (model, pack, normalisers) = shipped();
        let clips =
            Demonstrations::from_clips(&[(still(30), 1.0, false)], &model, &normalisers.frame).unwrap();
        let config = EnvironmentConfig::default();
        let nodes = ["walk", "idle"].map(|name| GraphNode::new(name, &config, 1.0)).to_vec();
        let graph = TrainingGraph::along(nodes, &[vec![1, 0]], [1.0; 2]).unwrap();
        let hand_over = HandOver {
            skill: pack.skill_named("get_up").unwrap(),
            controller: Controller::with_config(
                pack,
                ControllerConfig { auto_recover: false, assist_rise: false, ..Default::default() },
            ),
            node: 1,
            out_of: Vec::new(),
        };
        let setting = Setting::new((model, normalisers), config, graph);
        let demonstrations = [&clips, &clips];
        let context = setting.context(&demonstrations);
        let mut env = Env::new(&setting.model, &context, Rng::new(7, 0));
        let mut up = 0;
        for _ in 0..8 {
            if env.start_at_hand_over(&context, &hand_over) {
                assert!(env.state.root_height() > 0.7 && !env.tracks());
                assert_eq!(env.command.position.as_node(), Some(NodeId::new(1)));
                up += 1;
            }
        }
        assert!(up >= 6, "{up} of 8");
    }
}
