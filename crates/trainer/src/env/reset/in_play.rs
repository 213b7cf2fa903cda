//! Starts as a game has them: the character is on its way, and comes to a stand for an episodic skill, or is told to go elsewhere.
//! The poses of clips are not those in which policies stand, walk and brake.

use glam::Vec2;
use physics_bridge::Snapshot;
use policy_core::training::{FrameHistory, TARGET_RANGE_METRES};
use policy_core::{Command as GameCommand, Controller, Goal, GraphPosition, SkillId};
use serde::{Deserialize, Serialize};

use super::super::command::{Command, DT_SECS};
use super::super::env::{Env, EnvContext};
use super::keep_one;

/// The gaits that lead up to a start, their variants, and a skill that may have ended just before it.
pub(crate) const PLAYED: &[&str] = &[
    "idle",
    "walk",
    "jog",
    "run",
    "crouch",
    "zombie_walk",
    "strafe",
    "idle_agile",
    "walk_agile",
    "jog_agile",
    "run_agile",
    "crouch_agile",
    "idle_steady",
    "walk_steady",
    "jog_steady",
    "run_steady",
    "walk_start",
    "walk_turn",
    "idle_stop",
    "roll",
];

/// Nodes for [`OutOf::Anything`]; the first one stands.
const OUT_OF: [&str; 14] = [
    "idle",
    "idle",
    "walk",
    "walk",
    "jog",
    "run",
    "crouch",
    "crouch",
    "zombie_walk",
    "strafe",
    "strafe",
    "strafe",
    "strafe",
    "strafe",
];

/// Nodes for [`OutOf::Stride`].
const STRIDES: [&str; 5] = ["walk", "walk", "jog", "jog", "run"];

/// The skill that may have ended just before a start.
const ROLL: &str = "roll";

/// Share of the starts out of a walk, a jog or a run that have a roll before them.
const ROLL_SHARE: f32 = 0.25;

/// Longest time on the way, seconds.
const WAY_SECS: f32 = 3.0;

/// Time between two directions on the way, seconds.
const DIRECTION_SECS: [f32; 2] = [0.5, 2.0];

/// Share of those stretches without a target: a character that halts while it strafes stands on straight legs, and soon tips over.
const HALT_SHARE: f32 = 0.3;

/// Half of the characters that strafe turn on their way, at most so fast, radians a second.
const FACING_RATE: f32 = 3.0;

/// Longest rest after it, seconds. Half of the starts have none.
const REST_SECS: f32 = 3.0;

/// Longest time from letting go of the stick until the policy that learns takes over, seconds: a game blends it in.
const LET_GO_SECS: f32 = 0.3;

/// The same for a variant that stops: it takes over at once.
const STOPS_SECS: f32 = 0.07;

/// Shortest time on the way to a start in the middle of a stride, seconds: so long a run takes to begin.
const STRIDE_SECS: f32 = 1.2;

/// Speed of a character that stands, metres per second.
const STANDS_MPS: f32 = 0.3;

/// A start that takes longer is given up, seconds.
const LIMIT_SECS: f32 = 10.0;

/// Starts that a character keeps; each of them takes as long as several episodes.
const KEPT: usize = 6;

/// Share of the starts that are one of those, once there are so many.
const KEPT_SHARE: f32 = 0.8;

/// Starts where a game starts an episodic skill, or where a variant begins to act.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InPlayConfig {
    /// Share of episodes.
    pub share: f32,
    /// Speed below which the skill starts, as in the plan of the pack, metres per second. Leave it out for a variant of a gait. The
    /// variant of a standing gait starts up to 0.3 s after the stick is released, the variant of a moving gait from standing or mid-gait.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub maximum_speed_mps: Option<f32>,
    /// Out of what it starts.
    #[serde(default)]
    pub out_of: OutOf,
}

/// What a character does before it starts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OutOf {
    /// Any gait but a crawl, with turns, halts and rolls.
    #[default]
    Anything,
    /// It stands, for a variant that sets off.
    Stand,
    /// It walks, jogs or runs, for a variant that turns, or that stops: that one starts as soon as the stick is released.
    Stride,
}

impl OutOf {
    /// Of so many starts one each is out of these nodes.
    fn nodes(self) -> &'static [&'static str] {
        match self {
            Self::Anything => &OUT_OF,
            Self::Stand => &OUT_OF[..1],
            Self::Stride => &STRIDES,
        }
    }
}

/// Starts that were played and have not failed, to return to.
pub(in super::super) type PlayedStarts = Vec<(Snapshot, FrameHistory)>;

impl Env {
    /// Starts an episode as a game would, for a share of the episodes; false for the others, and for a character that fell on the way.
    pub(super) fn start_in_play(&mut self, context: &EnvContext<'_>) -> bool {
        let (Some(config), Some(played)) = (context.config.reset.in_play, context.company) else {
            return false;
        };
        if !self.rng.chance(config.share) {
            return false;
        }
        let returns = self.played.len() == KEPT && self.rng.chance(KEPT_SHARE);
        if returns {
            let (snapshot, history) = &self.played[self.rng.index(KEPT)];
            self.character.restore(snapshot).expect("a snapshot of the same character");
            self.history.clone_from(history);
            self.character.sense_into(&mut self.state);
        } else if !self.play_up_to_start(context, &config, played.clone()) {
            return false;
        }
        if !self.begin_in_play(context) {
            return false;
        }
        if !returns {
            let start = (self.character.save(), self.history.clone());
            keep_one(&mut self.played, KEPT, start, &mut self.rng);
        }
        true
    }

    /// Plays up to the moment of the start. False when the physics diverges or that moment does not come.
    fn play_up_to_start(
        &mut self,
        context: &EnvContext<'_>,
        config: &InPlayConfig,
        mut controller: Controller,
    ) -> bool {
        self.start_standing(context);
        controller.reset();
        let pack = controller.pack().clone();
        let graph = pack.graph();
        let stand = graph.node_named(OUT_OF[0]).unwrap_or_default();
        controller.place_at(GraphPosition::node(stand));
        let strides = config.out_of == OutOf::Stride;
        let nodes = config.out_of.nodes();
        let out_of = graph.node_named(nodes[self.rng.index(nodes.len())]).unwrap_or(stand);
        let shortest = if strides { STRIDE_SECS } else { 0.3 };
        let way_secs = if out_of == stand { 0.0 } else { self.rng.range(shortest, WAY_SECS) };
        let goes = way_secs > 0.0 && self.rng.chance(0.5);
        // Once it is as slow as that, and on its way to a stand.
        let (rest_secs, below_mps) = match config.maximum_speed_mps {
            Some(most) if goes => (0.0, Some(most)),
            Some(most) => (self.rng.range(0.0, REST_SECS), Some(most)),
            None if context.config.command.speed_mps == 0.0 => {
                (self.rng.range(0.0, if strides { STOPS_SECS } else { LET_GO_SECS }), None)
            }
            None if goes || strides => (0.0, None),
            None => (self.rng.range(0.5, REST_SECS), Some(STANDS_MPS)),
        };
        let rolls = |skill: &SkillId| pack.skills()[skill.index()].starts_from(out_of);
        let mut roll =
            pack.skill_named(ROLL).filter(rolls).filter(|_| !strides && self.rng.chance(ROLL_SHARE));
        let (mut settled_at, mut turns_at) = (0.0, 0.0);
        let mut facing = self.heading().direction();
        let (mut direction, mut halts) = (facing, false);
        let looks_round = if self.rng.chance(0.5) { self.rng.range(-FACING_RATE, FACING_RATE) } else { 0.0 };
        for tick in 0..(LIMIT_SECS / DT_SECS) as u32 {
            let secs = tick as f32 * DT_SECS;
            let root = *self.state.root();
            let report = controller.report();
            let rolling = report.skill.is_some() || report.pending_skill.is_some();
            if rolling {
                settled_at = secs + controller.config().settle_secs;
            }
            let ready = below_mps.is_none_or(|most| {
                report.position.nearest_node() == stand && root.linear_velocity.truncate().length() < most
            });
            if ready && secs >= settled_at.max(way_secs + rest_secs) {
                return true;
            }
            if secs >= turns_at {
                direction = facing.rotate(Vec2::from_angle(self.rng.angle()));
                halts = !strides && self.rng.chance(HALT_SHARE);
                turns_at = secs + self.rng.range(DIRECTION_SECS[0], DIRECTION_SECS[1]);
            }
            facing = facing.rotate(Vec2::from_angle(looks_round * DT_SECS));
            let ahead = root.position.truncate() + TARGET_RANGE_METRES * direction;
            let on_its_way = secs < way_secs;
            let asked = GameCommand {
                target: ((on_its_way && !halts) || rolling).then_some(ahead),
                facing: graph.node(out_of).strafes.then_some(facing),
                goal: Goal::Node(if on_its_way { out_of } else { stand }),
                skill: if secs >= way_secs / 2.0 { roll.take() } else { None },
                ..GameCommand::default()
            };
            if !self.step_before(context, controller.tick(&self.state, &asked, DT_SECS)) {
                return false;
            }
        }
        false
    }

    /// Begins the episode where the character is, and the clip of a skill that tracks one; false where it has failed at once.
    fn begin_in_play(&mut self, context: &EnvContext<'_>) -> bool {
        self.tracker = false;
        self.command = Command::start(&context.config.command, context.graph, false, &mut self.rng);
        self.aim(context);
        let tracks = context.config.reward.tracking_weight > 0.0;
        self.tracking = tracks.then(|| self.track_from_the_beginning(context));
        !self.has_failed(context)
    }
}

#[cfg(test)]
#[path = "in_play_tests.rs"]
mod tests;
