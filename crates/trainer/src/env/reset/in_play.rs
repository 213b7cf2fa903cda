//! Starts of an episodic skill as a game has them: the character stands, or was on its way and came to a stand for the skill. The
//! poses of clips are not those in which policies stand and brake.

use policy_core::training::TARGET_RANGE_METRES;
use policy_core::{Command as GameCommand, Goal, GraphPosition};
use serde::{Deserialize, Serialize};

use super::super::command::{Command, DT_SECS};
use super::super::env::{Env, EnvContext};

/// The gaits that lead up to a start, and their variants.
pub(crate) const GAITS: &[&str] = &[
    "idle",
    "walk",
    "jog",
    "run",
    "idle_agile",
    "walk_agile",
    "jog_agile",
    "run_agile",
    "idle_steady",
    "walk_steady",
    "jog_steady",
];

/// Of so many starts one each is out of these nodes.
const OUT_OF: [&str; 8] = ["idle", "idle", "idle", "walk", "walk", "walk", "jog", "run"];

/// Longest time on the way, seconds.
const WAY_SECS: f32 = 3.0;

/// Longest rest after it, seconds. Half of the starts have none.
const REST_SECS: f32 = 4.0;

/// A start that takes longer is given up, seconds.
const LIMIT_SECS: f32 = 9.0;

/// Starts where a game starts an episodic skill.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InPlayConfig {
    /// Share of episodes.
    pub share: f32,
    /// Speed below which the skill starts, as in the plan of the pack, metres per second.
    pub maximum_speed_mps: f32,
}

impl Env {
    /// Starts an episode in the tick in which a game would start the skill, for a share of the episodes; false for the others, and for a
    /// character that fell on the way.
    pub(super) fn start_in_play(&mut self, context: &EnvContext<'_>) -> bool {
        let (Some(config), Some(gaits)) = (context.config.reset.in_play, context.company) else {
            return false;
        };
        if !self.rng.chance(config.share) {
            return false;
        }
        self.start_standing(context);
        let mut controller = gaits.clone();
        controller.reset();
        let graph = gaits.pack().graph();
        let stand = graph.node_named(OUT_OF[0]).unwrap_or_default();
        controller.place_at(GraphPosition::node(stand));
        let out_of = graph.node_named(OUT_OF[self.rng.index(OUT_OF.len())]).unwrap_or(stand);
        let moves = out_of != stand;
        let way_secs = if moves { self.rng.range(0.3, WAY_SECS) } else { 0.0 };
        let rest_secs = if moves && self.rng.chance(0.5) { 0.0 } else { self.rng.range(0.0, REST_SECS) };
        let direction = self.heading().direction();
        for tick in 0..(LIMIT_SECS / DT_SECS) as u32 {
            let secs = tick as f32 * DT_SECS;
            let root = *self.state.root();
            let slow = root.linear_velocity.truncate().length() < config.maximum_speed_mps;
            let arrived = controller.report().position.nearest_node() == stand;
            if secs >= way_secs + rest_secs && slow && arrived {
                return self.begin_in_play(context);
            }
            let on_its_way = secs < way_secs;
            let asked = GameCommand {
                target: on_its_way.then(|| root.position.truncate() + TARGET_RANGE_METRES * direction),
                goal: Goal::Node(if on_its_way { out_of } else { stand }),
                ..GameCommand::default()
            };
            let targets = controller.tick(&self.state, &asked, DT_SECS);
            if !self.step_before(context, targets) {
                return false;
            }
        }
        false
    }

    /// Begins the clip where the character is; false where it has failed at once.
    fn begin_in_play(&mut self, context: &EnvContext<'_>) -> bool {
        self.tracker = false;
        self.command = Command::start(&context.config.command, context.graph, false, &mut self.rng);
        self.aim(context);
        self.tracking = Some(self.track_from_the_beginning(context));
        !self.has_failed(context)
    }
}

#[cfg(test)]
mod tests {
    use policy_core::{Controller, ControllerConfig};
    use random::Rng;

    use super::super::super::config::EnvironmentConfig;
    use super::super::super::demonstrations::Demonstrations;
    use super::super::super::graph::{GraphNode, TrainingGraph};
    use super::super::super::made_up::{shipped, still};
    use super::super::super::termination::TerminationHeights;
    use super::*;

    #[test]
    fn a_skill_starts_where_a_character_is_slow_enough_and_tracks_its_clip_from_there() {
        let (model, pack, normalisers) = shipped();
        let clips =
            Demonstrations::from_clips(&[(still(30), 1.0, false)], &model, &normalisers.frame).unwrap();
        let mut config = EnvironmentConfig::default();
        config.reward.tracking_weight = 0.9;
        config.reset.in_play = Some(InPlayConfig { share: 1.0, maximum_speed_mps: 0.5 });
        let gaits =
            Controller::with_config(pack, ControllerConfig { auto_recover: false, ..Default::default() });
        let context = EnvContext {
            config: &config,
            skeleton: model.skeleton(),
            graph: &TrainingGraph::alone(vec![GraphNode::new("kick", &config, 1.0)], 0).unwrap(),
            demonstrations: &[&clips],
            start_demonstrations: None,
            hand_over: &[],
            normalisers: &normalisers,
            heights: &TerminationHeights::new(&config.termination, model.skeleton()).unwrap(),
            pushed: &[],
            company: Some(&gaits),
        };
        let mut env = Env::new(&model, &context, Rng::new(8, 0));
        let (mut started, mut moving) = (0, 0);
        for _ in 0..12 {
            if env.start_in_play(&context) {
                let speed = env.state.root().linear_velocity.truncate().length();
                assert!(speed < 0.5 && env.tracks(), "{speed}");
                started += 1;
                moving += u32::from(speed > 0.15);
            }
        }
        assert!(started >= 9 && moving >= 1, "{started} started, {moving} of them while they braked");
        let without = EnvironmentConfig::default();
        assert!(!env.start_in_play(&EnvContext { config: &without, ..context }));
    }
}
