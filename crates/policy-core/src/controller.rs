//! One character's controller: rows 4 to 7 of the control tick. It composes graph, skills, observation,
//! policy and action. The pack is shared; a [`ControllerState`] is what changes.

use alloc::sync::Arc;
use alloc::vec::Vec;

use crate::action::ActionScaling;
use crate::agility::OnGraph;
use crate::blend::Blend;
use crate::command::Command;
use crate::controller_state::{ControllerState, StateError};
use crate::evaluator::{BlendEvaluator, BlendMode};
use crate::fall::Heights;
use crate::footing::next_unevenness;
use crate::ids::{PolicyId, SkillId};
use crate::observation::{observe_into, target_input};
use crate::pack::CharacterPack;
use crate::path::GraphPosition;
use crate::report::{StateFault, TickReport};
use crate::scorer::Scorer;
use crate::skill::{SkillEnd, clock_input};
use crate::state::{CharacterState, JointTargets};
use crate::strafe::{face_in_observation, strafing_share};
use crate::variants::{Shares, standing_share, with_variants};

mod config;
mod skills;
mod swap;
mod travel;

pub use self::config::ControllerConfig;
pub use self::swap::SwapError;

/// Longest time a tick may stand for, seconds.
const LONGEST_TICK: f32 = 0.25;

/// A tick this much longer or shorter than the control period, relative to it, is reported.
const RATE_TOLERANCE: f32 = 0.25;

/// No action is larger than this; policies stay within about 1.
const ACTION_LIMIT: f32 = 10.0;

/// Steers one character: turns what it senses and what the game asks into joint targets.
#[derive(Clone, Debug)]
pub struct Controller {
    pack: Arc<CharacterPack>,
    config: ControllerConfig,
    state: ControllerState,
    evaluator: BlendEvaluator,
    scorer: Scorer,
    input: Vec<f32>,
    action: Vec<f32>,
    /// Seconds of the tick that was prepared last.
    tick_secs: f32,
}

impl Controller {
    /// A controller at the first node of the pack's graph. Allocates; ticks don't.
    #[must_use]
    pub fn new(pack: Arc<CharacterPack>) -> Self {
        Self::with_config(pack, ControllerConfig::default())
    }

    /// A controller with other choices than the default. Allocates; ticks don't.
    #[must_use]
    pub fn with_config(pack: Arc<CharacterPack>, config: ControllerConfig) -> Self {
        let skeleton = pack.skeleton();
        let mut controller = Self {
            evaluator: BlendEvaluator::new(&pack.policies()[0], config.arithmetic, config.cache_blends),
            scorer: Scorer::new(&pack),
            state: ControllerState::new(&pack),
            input: alloc::vec![0.0; skeleton.policy_input_len()],
            action: alloc::vec![0.0; skeleton.joint_count()],
            tick_secs: 0.0,
            pack,
            config,
        };
        controller.reset();
        controller
    }

    /// Back to the start node, as after the character was put elsewhere. A running skill is interrupted, which the next
    /// tick reports.
    pub fn reset(&mut self) {
        let start = self.start_node();
        let interrupted = self.state.report.skill.map(|s| s.skill).or(self.state.interrupted);
        self.state.clear();
        self.evaluator.set_rest(self.state.rest, self.pack.policies());
        self.state.report = TickReport::at(GraphPosition::node(start));
        self.state.interrupted = interrupted;
        self.input.fill(0.0);
        self.zero_action();
    }

    /// Puts the controller at a position on the graph at once, without travelling. A running skill is interrupted, which the
    /// next tick reports. Returns false and does nothing when the graph has no such position.
    pub fn place_at(&mut self, position: GraphPosition) -> bool {
        let exists = self.pack.graph().contains(position);
        if exists {
            self.state.interrupted =
                self.state.report.skill.take().map(|s| s.skill).or(self.state.interrupted);
            self.set_position(position);
            self.state.fall.reset();
        }
        exists
    }

    /// The shared pack.
    #[must_use]
    pub fn pack(&self) -> &Arc<CharacterPack> {
        &self.pack
    }

    /// The choices it was made with.
    #[must_use]
    pub fn config(&self) -> &ControllerConfig {
        &self.config
    }

    /// Sets how a blend becomes an action, from the next tick on.
    pub fn set_blend_mode(&mut self, mode: BlendMode) {
        self.config.blend_mode = mode;
    }

    /// What the last tick did.
    #[must_use]
    pub fn report(&self) -> &TickReport {
        &self.state.report
    }

    /// True from a fall until the character is on its feet again: it has fallen, or the recovery skill raises it. Standing up
    /// out of a low gait, such as a crawl, is no fall.
    #[must_use]
    pub fn is_down(&self) -> bool {
        let report = &self.state.report;
        let recovers = report.skill.is_some_and(|progress| Some(progress.skill) == self.pack.recovery());
        report.fallen || (recovers && self.state.fall.rising_seconds == 0.0)
    }

    /// Inputs of the policy in the last tick: the normalised observation, then the target.
    #[must_use]
    pub fn policy_input(&self) -> &[f32] {
        &self.input
    }

    /// Joint targets of the last tick, radians.
    #[must_use]
    pub fn joint_targets(&self) -> &JointTargets {
        &self.state.targets
    }

    /// Forgets a skill that was requested and has not started. Returns it.
    pub fn cancel_pending_skill(&mut self) -> Option<SkillId> {
        self.state.report.pending_skill.take()
    }

    /// Copies everything that the next tick depends on. Does not allocate.
    ///
    /// # Panics
    /// When `out` was made for a pack with another skeleton.
    pub fn save_into(&self, out: &mut ControllerState) {
        out.copy_from(&self.state);
        out.rest = *self.evaluator.rest();
    }

    /// Goes on from a saved state: the next ticks give the bits that they gave then. Does not allocate.
    ///
    /// # Errors
    /// When the state is not one of this pack; then the controller is unchanged.
    pub fn restore(&mut self, state: &ControllerState) -> Result<(), StateError> {
        state.check(&self.pack)?;
        self.state.copy_from(state);
        self.evaluator.set_rest(state.rest, self.pack.policies());
        Ok(())
    }

    /// One control tick: from what the character senses and what the game asks to joint targets, radians.
    ///
    /// `dt_secs` is the time since the last tick, clamped to [0, 0.25]. A state that is not finite or has the wrong size gives
    /// the targets of a zero action and a [`TickReport::fault`]. Never allocates, never panics.
    pub fn tick(&mut self, state: &CharacterState, command: &Command, dt_secs: f32) -> &JointTargets {
        if self.prepare(state, command, dt_secs) {
            let mut action = core::mem::take(&mut self.action);
            self.state.report.evaluation = self.evaluator.evaluate_into(
                self.pack.policies(),
                &self.state.report.blend,
                self.config.blend_mode,
                &self.input,
                &mut action,
            );
            self.accept(&action);
            self.action = action;
        }
        &self.state.targets
    }

    /// The first half of a tick: everything up to the policy. Then [`TickReport::blend`] is to be evaluated
    /// with [`Controller::policy_input`], by a batch say, and its action given to [`Controller::accept`].
    /// False when the state has a fault: the joint targets are set and there is nothing to evaluate.
    pub fn prepare(&mut self, state: &CharacterState, command: &Command, dt_secs: f32) -> bool {
        let dt = if dt_secs > 0.0 { dt_secs.min(LONGEST_TICK) } else { 0.0 };
        self.tick_secs = dt;
        let period = 1.0 / self.pack.control_hz();
        let report = &mut self.state.report;
        let within = (1.0 - RATE_TOLERANCE) * period..=(1.0 + RATE_TOLERANCE) * period;
        report.off_rate = !within.contains(&dt_secs);
        let interrupted = self.state.interrupted.take();
        report.skill_ended = interrupted.map(|skill| (skill, SkillEnd::Interrupted));
        (report.skill_started, report.skill_refused) = (None, None);
        report.fault = match state {
            s if !s.fits(self.pack.skeleton()) => Some(StateFault::WrongSize),
            s if !s.is_finite() => Some(StateFault::NonFinite),
            _ => None,
        };
        if report.fault.is_some() {
            self.zero_action();
            return false;
        }
        let heights = Heights::of(self.pack.skeleton(), state);
        let place = OnGraph::of(self.pack.graph(), &self.state.report);
        self.state.unevenness = match self.config.footing {
            true => next_unevenness(self.state.unevenness, place, state, dt),
            false => 0.0,
        };
        self.state.settle_secs = (self.state.settle_secs - dt).max(0.0);
        self.run_skill(state, heights, dt);
        self.detect_fall(state, dt);
        self.request_skill(command.skill, state, heights, dt);
        let assist = self.config.turn_assist.filter(|_| self.state.report.pending_skill.is_none());
        let command = assist.map_or(*command, |a| a.adjusted(self.pack.graph(), state, command));
        let command = self.giving_way(state, &command, dt);
        let command = self.settling(state, &command);
        let (command, goal) = self.bound_for(state, &command);
        self.travel(goal, (state, heights), dt);
        let command = self.state.rising.commanded(&command);
        self.follow_urgency(state, command.target, dt);
        self.keep_balance(state, &command, dt);
        self.choose_blend(state, &command);
        self.observe(state, &command, dt);
        true
    }

    /// The second half of a tick: makes joint targets of the policy's action. Numbers that are not finite
    /// count as zero.
    ///
    /// # Panics
    /// When `action` has not one number for each hinge.
    pub fn accept(&mut self, action: &[f32]) -> &JointTargets {
        assert_eq!(action.len(), self.state.targets.len(), "numbers of an action");
        let scaling = self.pack.action();
        let numbers = scaling.centre().iter().zip(scaling.gain()).zip(action);
        for (target, ((centre, gain), a)) in self.state.targets.iter_mut().zip(numbers) {
            let a = if a.is_finite() { a.clamp(-ACTION_LIMIT, ACTION_LIMIT) } else { 0.0 };
            *target = centre + gain * a;
        }
        self.hand_over();
        &self.state.targets
    }

    fn zero_action(&mut self) {
        let scaling: &ActionScaling = self.pack.action();
        self.state.targets.copy_from_slice(scaling.centre());
    }

    fn set_position(&mut self, position: GraphPosition) {
        let report = &mut self.state.report;
        (report.position, report.goal, report.blend) = (position, position, position.blend());
    }

    fn choose_blend(&mut self, state: &CharacterState, command: &Command) {
        let manual = command.blend.filter(|b| is_valid(b, self.pack.policies().len()));
        let report = &mut self.state.report;
        report.blend = match (report.skill, manual) {
            (Some(progress), _) => skills::way_out(&self.pack, progress, state, report.blend)
                .unwrap_or_else(|| Blend::single(self.pack.skills()[progress.acts.index()].policy)),
            (None, Some(blend)) => blend,
            (None, None) => {
                let blend = self.state.fall.acting_position(report.position).blend();
                let standing = standing_share(self.pack.graph(), &blend);
                let blend = self.state.capture_step.with_steps(self.pack.graph(), blend);
                let shares = Shares {
                    catch: self.state.catch.share,
                    rough_ground: self.state.unevenness,
                    standing,
                    agile: self.state.urgency,
                };
                self.state.rising.with_rise(with_variants(self.pack.graph(), blend, shares))
            }
        };
        if let (BlendMode::Switch, Some(policy)) = (self.config.blend_mode, report.blend.strongest()) {
            report.blend = Blend::single(policy);
        }
    }

    fn observe(&mut self, state: &CharacterState, command: &Command, dt: f32) {
        let strafing = strafing_share(self.pack.graph(), &self.state.report.blend);
        let (target_world, facing) = match self.state.capture_step.target(state) {
            Some((target, facing)) => (Some(target), Some(facing)),
            None => {
                let target = self.target(state, command);
                let goes = || target.map(|target| target - state.root().position.truncate());
                (self.steered(state, target, strafing, dt), command.facing.or_else(goes))
            }
        };
        let (skeleton, clock) = (self.pack.skeleton(), self.clock());
        let (observation, target) = self.input.split_at_mut(skeleton.observation_len());
        observe_into(skeleton, state, observation);
        face_in_observation(skeleton, state, (facing, strafing), observation);
        self.pack.tensors().observation_normaliser.normalise_in_place(observation);
        self.state.report.target = target_world.map_or([0.0; 2], |target| target_input(state, target));
        target.copy_from_slice(&clock.unwrap_or(self.state.report.target));
    }

    /// What the policy of a timed skill sees in place of the target, while that policy acts.
    fn clock(&self) -> Option<[f32; 2]> {
        let report = &self.state.report;
        let progress = report.skill?;
        let skill = &self.pack.skills()[progress.acts.index()];
        let acts = report.blend == Blend::single(skill.policy);
        skill.clock_seconds.filter(|_| acts).map(|seconds| clock_input(progress.seconds, seconds))
    }
}

fn is_valid(blend: &Blend, policies: usize) -> bool {
    let known = |policy: PolicyId| policy.index() < policies;
    let terms = blend.terms();
    !terms.is_empty() && terms.iter().all(|t| known(t.policy) && t.weights.iter().all(|w| w.is_finite()))
}
