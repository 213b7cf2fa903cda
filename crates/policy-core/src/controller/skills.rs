//! Episodic skills of a controller: requests, falls, ends, and the hand-over of joint targets.

use alloc::sync::Arc;

use glam::Vec2;

use super::Controller;
use crate::balance::is_balanced;
use crate::blend::Blend;
use crate::command::{Command, Goal};
use crate::controller_state::ControllerState;
use crate::fall::{Heights, fall_height, lies};
use crate::footfall::{foot_comes_down, goes_straight};
use crate::heading::Heading;
use crate::ids::{NodeId, SkillId};
use crate::observation::TARGET_RANGE_METRES;
use crate::pack::CharacterPack;
use crate::path::GraphPosition;
use crate::skill::{Refusal, Skill, SkillEnd, SkillProgress};
use crate::state::CharacterState;
use crate::state_check::countdown_secs;

/// Longest time that a requested skill stays pending, seconds.
const LONGEST_PENDING_SECS: f32 = 4.0;

/// A skill that needs a character that comes to rest above its feet waits so long for it, seconds: one of another build may stand otherwise.
const LONGEST_UNBALANCED_SECS: f32 = 2.5;

/// A recovery that takes so long and is still may be stuck, seconds: a policy without noise that rests against something stays
/// there for good.
const STUCK_SECONDS: f32 = 2.5;

/// A root slower than this is still, metres and radians per second.
const STILL: [f32; 2] = [0.05, 0.2];

/// From then on another policy may act so long, once in this time, seconds.
const WAY_OUT_SECONDS: [f32; 2] = [1.0, 1.5];

/// A target further aside is shown at this angle while a character settles after a skill, radians.
const SETTLING_RADIANS: f32 = 0.5;

/// A target turned about the root until it lies nearly ahead.
fn nearly_ahead(state: &CharacterState, target: Vec2) -> Vec2 {
    let root = state.root();
    let heading = Heading::from_rotation(root.rotation);
    let to_target = heading.heading_from_world_2d(target - root.position.truncate());
    let off = libm::atan2f(to_target.y, to_target.x);
    let by = Heading::from_angle(off.clamp(-SETTLING_RADIANS, SETTLING_RADIANS) - off);
    root.position.truncate() + heading.world_from_heading_2d(by.world_from_heading_2d(to_target))
}

/// The lowest gait of the paths, to move a character on whose recovery is stuck; `None` while it is not. Once it acts it goes on
/// for the rest of its time: `before` is the blend of the last tick.
pub(super) fn way_out(
    pack: &CharacterPack,
    progress: SkillProgress,
    state: &CharacterState,
    before: Blend,
) -> Option<Blend> {
    let late = progress.seconds - STUCK_SECONDS;
    let [acts, every] = WAY_OUT_SECONDS;
    if pack.recovery() != Some(progress.skill) || late < 0.0 || libm::fmodf(late, every) >= acts {
        return None;
    }
    let height = |node: &NodeId| pack.graph().node(*node).fall_height.unwrap_or(0.0);
    let nodes = pack.graph().paths().iter().flat_map(|path| path.nodes().iter().copied());
    let lowest = GraphPosition::node(nodes.min_by(|a, b| height(a).total_cmp(&height(b)))?).blend();
    let root = state.root();
    let still = root.linear_velocity.length() < STILL[0] && root.angular_velocity.length() < STILL[1];
    (still || before == lowest).then_some(lowest)
}

impl Controller {
    /// Runs the skill that is on for a tick, and ends it when it has come to its end.
    pub(super) fn run_skill(&mut self, state: &CharacterState, heights: Heights, dt: f32) {
        let Some(mut progress) = self.state.report.skill else { return };
        let pack = Arc::clone(&self.pack);
        let skill = &pack.skills()[progress.acts.index()];
        let history = &mut self.state.history;
        let score = skill.discriminator.and_then(|d| self.scorer.score(&pack, d, state, history));
        let Some(end) = progress.tick(&skill.end, score, heights.root, dt) else {
            self.state.report.skill = Some(progress);
            return;
        };
        self.state.report.skill_ended = Some((progress.skill, end));
        self.state.report.skill = None;
        self.set_position(GraphPosition::node(skill.returns_to));
        self.state.fall.reset();
        self.begin_hand_over();
        self.state.settle_secs = countdown_secs(self.config.settle_secs);
        // A character that lies where its time to stand up is over tries again at once.
        let low = fall_height(pack.graph(), self.state.report.position).is_some_and(|h| heights.root < h);
        if self.config.auto_recover && low && pack.recovery() == Some(progress.skill) {
            self.recover(progress.skill);
        }
    }

    /// Starts the recovery skill of a character that lies. Another one that was pending is refused.
    fn recover(&mut self, recovery: SkillId) {
        let pending = self.state.report.pending_skill.filter(|pending| *pending != recovery);
        self.start_skill(SkillProgress::start(recovery));
        if let Some(pending) = pending {
            self.state.report.skill_refused = Some((pending, Refusal::Fell));
        }
    }

    /// Starts the recovery skill after a fall.
    pub(super) fn detect_fall(&mut self, state: &CharacterState, dt: f32) {
        let report = &mut self.state.report;
        // One that rises lies where it begins, and has a time of its own.
        let limit = match report.skill {
            Some(_) => None,
            None if self.state.rising.share > 0.0 => None,
            None => fall_height(self.pack.graph(), report.position),
        };
        let lies = lies(self.pack.graph(), limit, state);
        report.fallen = self.state.fall.tick(limit, lies, state.root_height(), dt);
        let recovery = self.pack.recovery().filter(|_| self.config.auto_recover && report.fallen);
        if let Some(recovery) = recovery {
            self.recover(recovery);
        }
    }

    /// Takes a request, and starts the pending skill where position and speed allow it.
    pub(super) fn request_skill(
        &mut self,
        request: Option<SkillId>,
        state: &CharacterState,
        heights: Heights,
        dt: f32,
    ) {
        if let Some(skill) = request {
            match self.refusal(skill, heights) {
                Some(why) => self.state.report.skill_refused = Some((skill, why)),
                None => (self.state.report.pending_skill, self.state.pending_secs) = (Some(skill), 0.0),
            }
        }
        let Some(pending) = self.state.report.pending_skill else { return };
        if self.state.report.skill.is_some() {
            return;
        }
        // Asked for while the character lay in another skill, which has set it on its feet.
        if let Some(why) = self.refusal(pending, heights) {
            self.state.report.skill_refused = Some((pending, why));
            self.state.report.pending_skill = None;
            return;
        }
        let acts = self.acting(pending, state);
        let skill = &self.pack.skills()[acts.index()];
        let speed = state.horizontal_speed();
        let [least, most] = [skill.minimum_speed_mps, skill.maximum_speed_mps];
        let stands =
            || self.state.pending_secs > LONGEST_UNBALANCED_SECS || is_balanced(self.pack.skeleton(), state);
        // One without conditions starts in any state.
        let calm = most.is_infinite() || (speed <= most && self.state.settle_secs == 0.0 && stands());
        let in_range = speed >= least && calm;
        let in_step = !skill.on_footfall
            || (self.state.settle_secs == 0.0
                && goes_straight(state)
                && foot_comes_down(self.pack.skeleton(), state));
        if in_range && in_step && skill.starts_from(self.state.report.position.nearest_node()) {
            return self.start_skill(SkillProgress { acts, ..SkillProgress::start(pending) });
        }
        self.state.pending_secs += dt;
        if self.state.pending_secs > LONGEST_PENDING_SECS {
            self.state.report.skill_refused = Some((pending, Refusal::TookTooLong));
            self.state.report.pending_skill = None;
        }
    }

    /// The command while the character settles after a skill: to stay in its gait and turn little.
    pub(super) fn settling(&self, state: &CharacterState, command: &Command) -> Command {
        if self.state.settle_secs <= 0.0 {
            return *command;
        }
        let target = command.target.map(|target| nearly_ahead(state, target));
        Command { goal: Goal::Stay, target, ..*command }
    }

    /// What acts once a skill starts: the skill, or what acts in its place in the stride of a gait.
    fn acting(&self, skill: SkillId, state: &CharacterState) -> SkillId {
        let skills = self.pack.skills();
        let node = self.state.report.position.nearest_node();
        let fits = |other: &SkillId| {
            let other = &skills[other.index()];
            other.starts_from(node) && state.horizontal_speed() >= other.minimum_speed_mps
        };
        skills[skill.index()].in_stride.iter().copied().find(fits).unwrap_or(skill)
    }

    /// The skill that is pending, or what would act in its place now.
    pub(super) fn pending(&self, state: &CharacterState) -> Option<&Skill> {
        let pending = self.state.report.pending_skill?;
        Some(&self.pack.skills()[self.acting(pending, state).index()])
    }

    /// The target of a tick: the command's. A pending skill that needs speed runs straight ahead while there is none.
    pub(super) fn target(&self, state: &CharacterState, command: &Command) -> Option<Vec2> {
        let runs_up = self.pending(state).is_some_and(|s| s.minimum_speed_mps > 0.0)
            && self.state.report.skill.is_none();
        command.target.or_else(|| {
            let root = state.root();
            let ahead = Heading::from_rotation(root.rotation).direction() * TARGET_RANGE_METRES;
            runs_up.then(|| root.position.truncate() + ahead)
        })
    }

    /// Why a requested skill can only hurt. The recovery skill throws an upright character to the ground.
    fn refusal(&self, skill: SkillId, heights: Heights) -> Option<Refusal> {
        let Some(known) = self.pack.skills().get(skill.index()) else { return Some(Refusal::Unknown) };
        let up = self.pack.graph().node(known.returns_to).fall_height.is_some_and(|h| heights.has_risen(h));
        (up && self.pack.recovery() == Some(skill)).then_some(Refusal::Upright)
    }

    /// Starts a skill in place of whatever runs.
    pub(super) fn start_skill(&mut self, progress: SkillProgress) {
        let report = &mut self.state.report;
        if let Some(running) = report.skill.replace(progress) {
            report.skill_ended = Some((running.skill, SkillEnd::Interrupted));
        }
        (report.skill_started, report.pending_skill) = (Some(progress.skill), None);
        report.fallen = false;
        self.state.fall.reset();
        self.state.history.clear();
        self.state.settle_secs = 0.0;
        self.begin_hand_over();
    }

    /// Passes from the joint targets before a skill started or ended to the present policy's.
    pub(super) fn hand_over(&mut self) {
        let ControllerState { handover_secs, handover_from, targets, .. } = &mut self.state;
        if *handover_secs <= 0.0 {
            return;
        }
        let before = (*handover_secs / countdown_secs(self.config.handover_secs)).clamp(0.0, 1.0);
        for (target, from) in targets.iter_mut().zip(handover_from) {
            *target += before * (*from - *target);
        }
        *handover_secs = (*handover_secs - self.tick_secs).max(0.0);
    }

    fn begin_hand_over(&mut self) {
        if self.config.handover_secs > 0.0 {
            self.state.handover_from.copy_from_slice(&self.state.targets);
            self.state.handover_secs = countdown_secs(self.config.handover_secs);
        }
    }
}
