//! Starts as a game has them: the character is on its way, and comes to a stand for an episodic skill, or is told to go elsewhere.
//! The poses of clips are not those in which policies stand, walk and brake.

use glam::Vec2;
use physics_bridge::Snapshot;
use policy_core::training::{FrameHistory, Path, TARGET_RANGE_METRES, foot_comes_down};
use policy_core::{Command as GameCommand, Controller, Goal, GraphPosition, PathId, SkillId};

use super::super::command::{Command, DT_SECS};
use super::super::env::{Env, EnvContext};
use super::super::randomisation::PUSH_SECS;
use super::keep_one;

mod config;

pub use config::{InPlayConfig, OutOf};

/// Share of the walks that begin with a push and are half-way between standing and walking, as half a stick has it.
const HALF_SHARE: f32 = 0.25;

/// The skill that may have ended just before a start.
const ROLL: &str = "roll";

/// Share of the starts out of a walk, a jog or a run that have a roll before them.
const ROLL_SHARE: f32 = 0.25;

/// Longest time on the way, seconds.
const WAY_SECS: f32 = 3.0;

/// Time on the way down to a low gait and in it, seconds: the way takes 4 s.
const LOW_SECS: [f32; 2] = [2.0, 6.0];

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

/// Time from the beginning of a push to a start that catches it, seconds: a game takes it for one once the body tips over.
const PUSHED_SECS: [f32; 2] = [0.07, 0.2];

/// A push from behind comes within this angle, radians.
const FROM_BEHIND_RADIANS: f32 = 0.4;

/// Speed of a character that stands, metres per second.
const STANDS_MPS: f32 = 0.3;

/// Speed of a character that starts out of a run, at least, metres per second: the least that the pack lets it leap at.
pub const RUNS_MPS: f32 = 1.5;

/// A start that takes longer is given up, seconds.
const LIMIT_SECS: f32 = 10.0;

/// Starts that a character keeps; each of them takes as long as several episodes.
const KEPT: usize = 6;

/// Share of the starts that are one of those, once there are so many.
const KEPT_SHARE: f32 = 0.8;

/// Starts that were played and have not failed, to return to.
pub(in super::super) type PlayedStarts = Vec<PlayedStart>;

/// A character at a start.
#[derive(Clone, Debug)]
pub(in super::super) struct PlayedStart {
    snapshot: Snapshot,
    history: FrameHistory,
    /// The way that it went, radians, where it is to go on.
    way: Option<f32>,
}

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
            let start = &self.played[self.rng.index(KEPT)];
            self.character.restore(&start.snapshot).expect("a snapshot of the same character");
            self.history.clone_from(&start.history);
            self.character.sense_into(&mut self.state);
            let way = start.way;
            return self.begin_in_play(context, way);
        }
        let Some(way) = self.play_up_to_start(context, &config, played.clone()) else { return false };
        let way = Some(way.to_angle()).filter(|_| config.out_of.pushes());
        if !self.begin_in_play(context, way) {
            return false;
        }
        let start = PlayedStart { snapshot: self.character.save(), history: self.history.clone(), way };
        keep_one(&mut self.played, KEPT, start, &mut self.rng);
        true
    }

    /// Plays up to the moment of the start, and tells the way that it was to go. `None` when the physics diverges or that moment does not come.
    fn play_up_to_start(
        &mut self,
        context: &EnvContext<'_>,
        config: &InPlayConfig,
        mut controller: Controller,
    ) -> Option<Vec2> {
        self.start_standing(context);
        controller.reset();
        let pack = controller.pack().clone();
        let graph = pack.graph();
        let stand = graph.node_named(OutOf::Stand.nodes()[0]).unwrap_or_default();
        controller.place_at(GraphPosition::node(stand));
        let strides = config.out_of.strides();
        let (pushes, mut takes_over_at) = (config.out_of.pushes(), None);
        let runs = config.out_of == OutOf::Run;
        let skeleton = pack.skeleton();
        let nodes = config.out_of.nodes();
        let out_of = graph.node_named(nodes[self.rng.index(nodes.len())]).unwrap_or(stand);
        let low = config.out_of == OutOf::Low;
        let [shortest, longest] = match config.out_of {
            OutOf::Low | OutOf::PushInCrouch => LOW_SECS,
            _ => [if strides { STRIDE_SECS } else { 0.3 }, WAY_SECS],
        };
        let way_secs = if out_of == stand { 0.0 } else { self.rng.range(shortest, longest) };
        let goes = way_secs > 0.0 && self.rng.chance(0.5);
        // Once it is as slow as that, and on its way to a stand.
        let (rest_secs, below_mps) = match config.maximum_speed_mps {
            Some(most) if goes => (0.0, Some(most)),
            Some(most) => (self.rng.range(0.0, REST_SECS), Some(most)),
            // Told to stand, it has turned back half-way down.
            None if low => (self.rng.range(0.0, LET_GO_SECS), None),
            None if context.config.command.speed_mps == 0.0 => {
                (self.rng.range(0.0, if strides { STOPS_SECS } else { LET_GO_SECS }), None)
            }
            None if goes || strides => (0.0, None),
            None => (self.rng.range(0.5, REST_SECS), Some(STANDS_MPS)),
        };
        let rolls = |skill: &SkillId| pack.skills()[skill.index()].starts_from(out_of);
        let first_steps = |path: &Path| path.nodes().starts_with(&[stand, out_of]);
        let halfway = graph.paths().iter().position(first_steps).filter(|_| pushes);
        let halfway = halfway.filter(|_| self.rng.chance(HALF_SHARE));
        let (goal, push) = match halfway {
            Some(path) => (Goal::Path { path: PathId::new(path), coordinate: 0.5 }, 0.5),
            None => (Goal::Node(out_of), 1.0),
        };
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
            let speed = self.state.horizontal_speed();
            let slow = below_mps.is_none_or(|most| report.position.nearest_node() == stand && speed < most);
            let ready = slow && (!runs || (speed >= RUNS_MPS && foot_comes_down(skeleton, &self.state)));
            if ready && secs >= settled_at.max(way_secs + rest_secs) {
                match takes_over_at {
                    None if pushes => {
                        self.push_start(context, config, direction);
                        takes_over_at = Some(secs + self.rng.range(PUSHED_SECS[0], PUSHED_SECS[1]));
                    }
                    Some(at) if secs < at => {}
                    _ => return Some(direction),
                }
            }
            if secs >= turns_at {
                let turns = if pushes { 0.0 } else { self.rng.angle() };
                direction = facing.rotate(Vec2::from_angle(turns));
                halts = !strides && self.rng.chance(HALT_SHARE);
                turns_at = secs + self.rng.range(DIRECTION_SECS[0], DIRECTION_SECS[1]);
            }
            facing = facing.rotate(Vec2::from_angle(looks_round * DT_SECS));
            let ahead = root.position.truncate() + push * TARGET_RANGE_METRES * direction;
            let on_its_way = secs < way_secs || pushes || runs;
            let asked = GameCommand {
                target: ((on_its_way && !halts) || rolling).then_some(ahead),
                facing: graph.node(out_of).strafes.then_some(facing),
                goal: if on_its_way { goal } else { Goal::Node(stand) },
                skill: if secs >= way_secs / 2.0 { roll.take() } else { None },
                ..GameCommand::default()
            };
            if !self.step_before(context, controller.tick(&self.state, &asked, DT_SECS)) {
                return None;
            }
        }
        None
    }

    /// Begins a push on a character that goes this way.
    fn push_start(&mut self, context: &EnvContext<'_>, config: &InPlayConfig, way: Vec2) {
        let newton = self.rng.range(config.least_push, 1.0) * context.config.randomisation.push_newton;
        let off_way = match self.rng.chance(config.from_behind_share) {
            true => self.rng.range(-FROM_BEHIND_RADIANS, FROM_BEHIND_RADIANS),
            false => self.rng.angle(),
        };
        let force = newton * way.rotate(Vec2::from_angle(off_way));
        self.push_body(context, force, PUSH_SECS);
    }

    /// Begins the episode where the character is, and the clip of a skill that tracks one; false where it has failed at once. `way` is the one
    /// to go on, radians.
    fn begin_in_play(&mut self, context: &EnvContext<'_>, way: Option<f32>) -> bool {
        self.tracker = false;
        self.command = Command::start(&context.config.command, context.graph, false, &mut self.rng);
        self.aim(context);
        if let Some(way) = way {
            self.command.go_straight(context.graph, self.root_position(), way);
        }
        let tracks = context.config.reward.tracking_weight > 0.0;
        self.tracking = tracks.then(|| self.track_from_the_beginning(context));
        !self.has_failed(context)
    }
}

#[cfg(test)]
#[path = "in_play_tests.rs"]
mod tests;
