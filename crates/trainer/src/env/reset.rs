//! Where episodes start: reference-state initialisation in clips, standing, limp on the ground, before an earlier failure, or
//! where an episodic skill hands over.

use clips::placed;
use physics_bridge::{Pose, Terrain, WALKING_START_MPS};
use policy_core::{Heading, JointTargets};
use random::Rng;
use random::limp::{go_limp, random_attitude};
use serde::{Deserialize, Serialize};

use super::averaged::AveragedVelocity;
use super::command::Command;
use super::demonstrations::ReferenceState;
use super::env::{Env, EnvContext};
use super::exploration::Exploration;
use super::track_clip::{Tracking, own_clips};

mod hand_over;
mod in_play;
mod pre_failure;

pub use self::hand_over::HandOver;
pub(super) use self::in_play::PlayedStarts;
pub use self::in_play::{InPlayConfig, OutOf, RUNS_MPS};
pub(super) use self::pre_failure::PreFailureStates;

/// Where episodes start.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ResetConfig {
    /// Share of episodes that start in a pose of other clips than the skill's own.
    pub other_clips_share: f32,
    /// Those clips; the parent's when there are none.
    pub clips: Vec<String>,
    /// Share of episodes that start standing, moving ahead at up to a walk's speed, as a game places a character.
    pub standing_share: f32,
    /// True to start in the clips of the nodes around the position on the graph, not in the skill's own alone.
    pub along_path: bool,
    /// Share of episodes that start in the clips of any node.
    pub any_node_share: f32,
    /// Share of episodes that start limp on the ground, dropped there in a random attitude.
    pub limp_share: f32,
    /// Share of episodes that start a second or two before an earlier failure of the same character, with the command it had
    /// then: rare failures are met often.
    pub pre_failure_share: f32,
    /// Episodes of an episodic skill that start where a game starts it; none without.
    pub in_play: Option<InPlayConfig>,
    /// Joint training only: episodes that start where episodic skills hand over to a node.
    pub hand_over: Vec<HandOverConfig>,
}

/// Starts where an episodic skill hands over.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HandOverConfig {
    /// The skill, by its name in the plan of the pack.
    pub skill: String,
    /// Share of episodes.
    pub share: f32,
    /// Skills of the paths in whose clips it starts; dropped limp when there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub out_of: Vec<String>,
}

/// Characters on a terrain start this near to its middle, metres along each axis.
const TERRAIN_HALF_METRES: f32 = 25.0;

/// Ticks of an episode that starts before a failure, at most.
const BEFORE_FAILURE_TICKS: u32 = 120;

/// Height that a limp character is dropped from, as a share of that of a standing root.
const DROP_SHARE: f32 = 0.85;

/// Draws of a start state until one does not fail at once; the last one is taken as it is.
const START_TRIES: usize = 4;

/// Keeps one more, in place of any where there are `most` already.
fn keep_one<T>(kept: &mut Vec<T>, most: usize, one: T, rng: &mut Rng) {
    if kept.len() < most {
        kept.push(one);
    } else {
        kept[rng.index(most)] = one;
    }
}

impl Env {
    /// Starts an episode. The first one begins anywhere in its time, later ones at most a quarter of it late: without random
    /// ages all episodes of a population without falls would end together.
    pub fn reset(&mut self, context: &EnvContext<'_>, first: bool) {
        self.start(context, first);
        self.faced_first = self.heading().direction();
        if let Some(company) = &mut self.company {
            company.begin(&self.character, context.config.meetings.pause_secs, &mut self.rng);
        }
    }

    fn start(&mut self, context: &EnvContext<'_>, first: bool) {
        let config = context.config;
        let ticks = config.episode_ticks as usize;
        self.born_at = self.rng.index(if first { ticks } else { ticks.div_ceil(4) }) as u32;
        self.age = self.born_at;
        self.pre_failure.begin();
        (self.stood_ticks, self.lost_ticks) = (0, 0);
        self.averaged = AveragedVelocity::default();
        self.delayed = self.rng.chance(config.randomisation.latency_share);
        self.has_late_targets = false;
        let before_failure =
            self.rng.chance(config.reset.pre_failure_share) && self.start_before_failure(context);
        self.exploration = Exploration::begin(&config.exploration, before_failure, &mut self.rng);
        if before_failure {
            return;
        }
        self.choose_ground_position();
        for (hand_over, of_config) in context.hand_over.iter().zip(&config.reset.hand_over) {
            if self.rng.chance(of_config.share) && self.start_at_hand_over(context, hand_over) {
                self.tracker = false;
                return;
            }
        }
        if self.start_in_play(context) {
            return;
        }
        self.tracker = self.rng.chance(config.reward.tracking_share);
        self.command = Command::start(&config.command, context.graph, self.tracker, &mut self.rng);
        let limp = self.rng.chance(config.reset.limp_share);
        let standing = !limp && self.rng.chance(config.reset.standing_share);
        if standing {
            self.start_standing(context);
        } else {
            self.start_in_clips(context, limp);
        }
        self.aim(context);
        let moves = self.state.root().linear_velocity.truncate();
        self.command.go_on(context.graph, self.root_position(), moves);
        // Of skills trained together only trackers track clips.
        let others = config.reward.tracking_share > 0.0 && !self.tracker;
        if standing && config.command.clock_seconds > 0.0 {
            self.tracking = Some(self.track_from_the_beginning(context));
        } else if limp || standing || config.reward.tracking_weight == 0.0 || others {
            self.tracking = None;
        }
    }

    /// Gives the command its first target, from where the character is; a stick of a timed skill points ahead, for the skill does not see it.
    fn aim(&mut self, context: &EnvContext<'_>) {
        let (position, radians) = (self.root_position(), self.heading().angle());
        self.command.aim(&context.config.command, context.graph, (position, radians), &mut self.rng);
        if context.config.command.clock_seconds > 0.0 {
            self.command.go_straight(context.graph, position, radians);
        }
    }

    /// A tick of the body before the episode begins; false when the physics diverged.
    fn step_before(&mut self, context: &EnvContext<'_>, targets: &JointTargets) -> bool {
        self.character.actuate(targets);
        if self.character.step().is_err() {
            return false;
        }
        self.character.sense_into(&mut self.state);
        self.push_frame(context);
        true
    }

    /// Chooses the horizontal position of the next start: the origin on flat ground, anywhere near the middle of a terrain.
    fn choose_ground_position(&mut self) {
        if self.character.model().terrain() != Terrain::Flat {
            let half = f64::from(TERRAIN_HALF_METRES);
            let mut along = || half * f64::from(self.rng.range(-1.0, 1.0));
            self.ground_position = (along(), along());
        }
    }

    /// Restores a state before an earlier failure; false when there is none.
    fn start_before_failure(&mut self, context: &EnvContext<'_>) -> bool {
        let Some(saved) = self.pre_failure.take(&mut self.rng) else { return false };
        self.character.restore(&saved.snapshot).expect("a snapshot of the same character");
        self.character.sense_into(&mut self.state);
        (self.history, self.command) = (saved.history, saved.command);
        (self.tracking, self.tracker) = (None, false);
        self.born_at = self.born_at.max(context.config.episode_ticks.saturating_sub(BEFORE_FAILURE_TICKS));
        self.age = self.born_at;
        true
    }

    /// Starts in clips, or limp from there.
    fn start_in_clips(&mut self, context: &EnvContext<'_>, limp: bool) {
        for _ in 0..START_TRIES {
            let start = self.reference_state(context);
            if limp {
                self.drop_limp(context, &start);
            } else {
                self.start_from(&start);
            }
            if !self.has_failed(context) {
                break;
            }
        }
    }

    /// A state of other clips, of any node's, of those around the position on the graph, or of the last node's.
    fn reference_state(&mut self, context: &EnvContext<'_>) -> ReferenceState {
        let start = &context.config.reset;
        let nodes = context.demonstrations.len();
        let node = match context.start_demonstrations {
            Some(other) if self.rng.chance(start.other_clips_share) => {
                self.tracking = Some(self.track_from_the_beginning(context));
                return other.sample_reference_state(&mut self.rng);
            }
            _ if self.rng.chance(start.any_node_share) => self.rng.index(nodes),
            _ if start.along_path => {
                let at = self.command.position;
                if self.rng.chance(at.t) { at.to.index() } else { at.from.index() }
            }
            _ => nodes - 1,
        };
        let start = context.demonstrations[node].sample_reference_state(&mut self.rng);
        self.tracking = (self.tracker || node == nodes - 1).then(|| Tracking::at_once(node, start.phase));
        start
    }

    /// From elsewhere into the clips of the skill that learns.
    fn track_from_the_beginning(&mut self, context: &EnvContext<'_>) -> Tracking {
        let clips = own_clips(context);
        let beginning = clips.sample_beginning(&mut self.rng);
        Tracking::into_clips(context.demonstrations.len() - 1, beginning, clips)
    }

    /// Sets the character down in a random heading, lifted until nothing is in the ground.
    fn start_from(&mut self, start: &ReferenceState) {
        let (x, y) = self.ground_position;
        let mut pose = placed(&start.pose, x, y, f64::from(self.rng.angle()));
        pose.qpos[2] += f64::from(self.character.model().height_at(x as f32, y as f32));
        self.set(&pose);
        let clearance = self.character.clearance();
        if clearance < 0.0 {
            pose.qpos[2] -= f64::from(clearance);
            self.set(&pose);
        }
        self.character.sense_into(&mut self.state);
        self.history.clear();
        for frame in start.frames.chunks_exact(self.character.model().skeleton().frame_len()) {
            self.history.push().copy_from_slice(frame);
        }
    }

    /// Stands the character in a random heading, moving that way at up to a walk's speed.
    fn start_standing(&mut self, context: &EnvContext<'_>) {
        let (x, y) = (self.ground_position.0 as f32, self.ground_position.1 as f32);
        let heading = Heading::from_angle(self.rng.angle());
        let speed = self.rng.range(0.0, WALKING_START_MPS);
        self.character.stand_at(x, y, heading, speed).expect("a position and a speed that are finite");
        self.character.sense_into(&mut self.state);
        self.history.clear();
        self.push_frame(context);
    }

    fn set(&mut self, pose: &Pose) {
        self.character.set_pose(&pose.qpos, &pose.qvel).expect("a clip's pose was tried when it was fitted");
    }

    /// Drops the character in a random attitude with loose joints and lets it fall for about a second.
    pub(super) fn drop_limp(&mut self, context: &EnvContext<'_>, start: &ReferenceState) {
        let mut pose = placed(&start.pose, self.ground_position.0, self.ground_position.1, 0.0);
        let turn = random_attitude(&mut self.rng);
        pose.qpos[2] = f64::from(DROP_SHARE * context.config.reward.standing_root_metres)
            + f64::from(
                self.character
                    .model()
                    .height_at(self.ground_position.0 as f32, self.ground_position.1 as f32),
            );
        pose.qpos[3..7].copy_from_slice(&[turn.w, turn.x, turn.y, turn.z].map(f64::from));
        pose.qvel.fill(0.0);
        if self.character.set_pose(&pose.qpos, &pose.qvel).is_err() {
            return self.start_from(start);
        }
        self.history.clear();
        let ticks = 12 + self.rng.index(24);
        for _ in 0..ticks {
            self.character.sense_into(&mut self.state);
            self.push_frame(context);
            go_limp(&mut self.character);
            if self.character.step().is_err() {
                return self.start_from(start);
            }
        }
        self.character.sense_into(&mut self.state);
        self.push_frame(context);
    }
}

#[cfg(test)]
#[path = "reset_tests.rs"]
mod tests;
