//! One character's controller: rows 4 to 7 of the control tick. It composes graph, skills, observation,
//! policy and action; the pack is shared, this is the state that is not.

use alloc::sync::Arc;

use crate::blend::Blend;
use crate::body::{Body, DOF_COUNT};
use crate::command::Command;
use crate::evaluator::{BlendEvaluator, BlendMode};
use crate::fall::{FallDetector, fall_height};
use crate::graph::GraphPosition;
use crate::judge::Judge;
use crate::kernel::Arithmetic;
use crate::observation::{OBSERVATION_LEN, POLICY_INPUT_LEN, observe_into, target_input};
use crate::pack::CharacterPack;
use crate::report::TickReport;
use crate::skill::{SkillEnd, SkillProgress};
use crate::state::{CharacterState, JointTargets};

/// Longest time a tick may stand for, seconds.
const LONGEST_TICK: f32 = 0.25;

/// No action is larger than this; policies stay within about 1.
const ACTION_LIMIT: f32 = 10.0;

/// Choices that are made once for a controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControllerConfig {
    /// How products are summed.
    pub arithmetic: Arithmetic,
    /// Keep the parameters of a resting blend; see [`BlendEvaluator::new`].
    pub keep_blends: bool,
    /// Start the pack's recovery skill when the character has fallen.
    pub recover: bool,
    /// Start it too when a rise, out of where low is right, has not come off within 0.8 s. Otherwise the character acts to and
    /// fro along the edge, and has fallen when that takes more than [`RISE_SECONDS`](crate::RISE_SECONDS).
    pub rise: bool,
    /// Index of the node to start at.
    pub start: usize,
}

impl Default for ControllerConfig {
    fn default() -> Self {
        Self { arithmetic: Arithmetic::Reproducible, keep_blends: true, recover: true, rise: true, start: 0 }
    }
}

/// Steers one character. Makes joint targets of what the character senses and what the game asks.
#[derive(Clone, Debug)]
pub struct Controller {
    pack: Arc<CharacterPack>,
    config: ControllerConfig,
    evaluator: BlendEvaluator,
    judge: Judge,
    fall: FallDetector,
    input: [f32; POLICY_INPUT_LEN],
    targets: JointTargets,
    report: TickReport,
}

impl Controller {
    /// A controller at the first node of the pack's graph. Allocates; ticks don't.
    #[must_use]
    pub fn new(pack: Arc<CharacterPack>) -> Self {
        Self::with_config(pack, ControllerConfig::default())
    }

    /// A controller with other choices than the default. A start node that is not there is the first.
    #[must_use]
    pub fn with_config(pack: Arc<CharacterPack>, config: ControllerConfig) -> Self {
        let evaluator = BlendEvaluator::new(&pack.policies()[0], config.arithmetic, config.keep_blends);
        let mut controller = Self {
            evaluator,
            judge: Judge::new(&pack),
            pack,
            config,
            fall: FallDetector::default(),
            input: [0.0; POLICY_INPUT_LEN],
            targets: JointTargets::default(),
            report: TickReport::default(),
        };
        controller.reset();
        controller
    }

    /// Back to the start node, as after the character was put elsewhere. Running skills are dropped.
    pub fn reset(&mut self) {
        let start = if self.config.start < self.pack.policies().len() { self.config.start } else { 0 };
        self.report = TickReport::default();
        self.place_at(GraphPosition::node(start));
        self.fall.reset();
        self.input.fill(0.0);
        self.zero_action();
    }

    /// Puts the controller at a place on the graph at once, without travelling. Ignored when it is no place of
    /// the graph.
    pub fn place_at(&mut self, position: GraphPosition) {
        let nodes = self.pack.policies().len();
        if position.from < nodes && position.to < nodes && (0.0..=1.0).contains(&position.t) {
            (self.report.position, self.report.goal) = (position, position);
            self.report.blend = blend_at(position);
        }
    }

    /// The shared pack.
    #[must_use]
    pub fn pack(&self) -> &Arc<CharacterPack> {
        &self.pack
    }

    /// What the last tick did.
    #[must_use]
    pub fn report(&self) -> &TickReport {
        &self.report
    }

    /// Inputs of the policy in the last tick: the normalised observation, then the target.
    #[must_use]
    pub fn policy_input(&self) -> &[f32; POLICY_INPUT_LEN] {
        &self.input
    }

    /// One control tick: from what the character senses and what the game asks to joint targets, radians.
    ///
    /// `dt_secs` is the time since the last tick, clamped to [0, 0.25]. A state that is not finite gives the
    /// targets of a zero action and [`TickReport::non_finite`]. Never allocates, never panics.
    pub fn tick(&mut self, state: &CharacterState, command: &Command, dt_secs: f32) -> &JointTargets {
        if !self.prepare(state, command, dt_secs) {
            return &self.targets;
        }
        let mut action = [0.0; DOF_COUNT];
        self.report.evaluation = self.evaluator.evaluate_into(
            self.pack.policies(),
            &self.report.blend,
            command.mode,
            &self.input,
            &mut action,
        );
        self.accept(&action)
    }

    /// The first half of a tick: everything up to the policy. Then [`TickReport::blend`] is to be evaluated
    /// with [`Controller::policy_input`], by a batch say, and its action given to [`Controller::accept`].
    /// False when the state is not finite: the joint targets are set and there is nothing to evaluate.
    pub fn prepare(&mut self, state: &CharacterState, command: &Command, dt_secs: f32) -> bool {
        let dt = if dt_secs > 0.0 { dt_secs.min(LONGEST_TICK) } else { 0.0 };
        self.report.non_finite = !state.is_finite();
        (self.report.skill_started, self.report.skill_ended) = (None, None);
        if self.report.non_finite {
            self.zero_action();
            return false;
        }
        self.run_skill(state, dt);
        self.watch_falls(state, dt);
        self.request_skill(command.skill);
        self.travel(state, command, dt);
        self.choose_blend(command);
        self.observe(state, command);
        true
    }

    /// The second half of a tick: makes joint targets of the policy's action. Numbers that are not finite
    /// count as zero.
    pub fn accept(&mut self, action: &[f32; DOF_COUNT]) -> &JointTargets {
        let safe = action.map(|a| if a.is_finite() { a.clamp(-ACTION_LIMIT, ACTION_LIMIT) } else { 0.0 });
        self.pack.action().targets_into(&safe, &mut self.targets);
        &self.targets
    }

    /// Joint targets of the last tick, radians.
    #[must_use]
    pub fn joint_targets(&self) -> &JointTargets {
        &self.targets
    }

    fn zero_action(&mut self) {
        self.pack.action().targets_into(&[0.0; DOF_COUNT], &mut self.targets);
    }

    fn run_skill(&mut self, state: &CharacterState, dt: f32) {
        let Some(mut progress) = self.report.skill else { return };
        let skill = &self.pack.skills()[progress.skill];
        let score = skill.discriminator.and_then(|d| self.judge.score(&self.pack, d, state));
        let Some(end) = progress.tick(&skill.end, score, state.height_of(Body::Pelvis), dt) else {
            self.report.skill = Some(progress);
            return;
        };
        self.report.skill_ended = Some((progress.skill, end));
        self.report.skill = None;
        self.place_at(GraphPosition::node(skill.returns_to));
        self.fall.reset();
        // A character that lies where its time to rise is over tries again at once.
        let low = fall_height(self.pack.graph(), self.report.position)
            .is_some_and(|h| state.height_of(Body::Pelvis) < h);
        if self.config.recover && low && self.pack.recovery() == Some(progress.skill) {
            self.start_skill(progress.skill);
        }
    }

    fn watch_falls(&mut self, state: &CharacterState, dt: f32) {
        let limit = match self.report.skill {
            Some(_) => None,
            None => fall_height(self.pack.graph(), self.report.position),
        };
        self.report.fallen = self.fall.tick(limit, state.height_of(Body::Pelvis), dt);
        if let (true, true, Some(recovery)) = (self.report.fallen, self.config.recover, self.pack.recovery())
        {
            self.start_skill(recovery);
        }
    }

    fn request_skill(&mut self, request: Option<usize>) {
        if let Some(skill) = request.filter(|&s| s < self.pack.skills().len()) {
            self.report.pending_skill = Some(skill);
        }
        let Some(pending) = self.report.pending_skill else { return };
        let skill = &self.pack.skills()[pending];
        let ready = skill.starts_from(self.report.position.nearest_node());
        if ready && self.report.skill.is_none() {
            self.start_skill(pending);
        }
    }

    fn start_skill(&mut self, skill: usize) {
        if let Some(running) = self.report.skill.replace(SkillProgress::start(skill)) {
            self.report.skill_ended = Some((running.skill, SkillEnd::Interrupted));
        }
        (self.report.skill_started, self.report.pending_skill) = (Some(skill), None);
        self.report.fallen = false;
        self.fall.reset();
        self.judge.reset();
    }

    /// Moves along the graph: to the nearest node a pending skill may start from, else to the command's goal. Out of where
    /// low is right it goes when the character has risen.
    fn travel(&mut self, state: &CharacterState, command: &Command, dt: f32) {
        if self.report.skill.is_some() {
            return;
        }
        let graph = self.pack.graph();
        let goal = match self.report.pending_skill.map(|s| &self.pack.skills()[s].entry) {
            Some(entry) => {
                let from = self.report.position.nearest_node();
                let cost = |node: &&usize| graph.routes().cost(from, **node);
                let nearest = entry.iter().min_by(|a, b| cost(a).total_cmp(&cost(b)));
                nearest.map(|&node| GraphPosition::node(node))
            }
            None => command.goal.position(graph),
        };
        self.report.goal = goal.unwrap_or(self.report.position);
        let mut next = self.report.position;
        graph.travel(&mut next, self.report.goal, dt);
        let limits = [self.report.position, next].map(|position| fall_height(graph, position));
        let heights = [Body::Pelvis, Body::Head].map(|body| state.height_of(body));
        if !self.fall.holds_back(limits, heights, dt) {
            self.report.position = next;
        } else if let (true, true, Some(recovery)) =
            (self.config.rise, self.fall.is_late(), self.pack.recovery())
        {
            self.start_skill(recovery);
        }
    }

    fn choose_blend(&mut self, command: &Command) {
        let manual = command.blend.filter(|b| is_valid(b, self.pack.policies().len()));
        self.report.blend = match (self.report.skill, manual) {
            (Some(progress), _) => Blend::single(self.pack.skills()[progress.skill].policy),
            (None, Some(blend)) => blend,
            (None, None) => blend_at(self.fall.place_to_act(self.report.position)),
        };
        if let (BlendMode::Switch, Some(policy)) = (command.mode, self.report.blend.strongest()) {
            self.report.blend = Blend::single(policy);
        }
    }

    fn observe(&mut self, state: &CharacterState, command: &Command) {
        let observation = self.input.first_chunk_mut::<OBSERVATION_LEN>().expect("the input starts with it");
        observe_into(state, observation);
        self.pack.tensors().observation_normaliser.normalise_in_place(observation);
        self.report.target = command.target.map_or([0.0; 2], |target| target_input(state, target));
        self.input[OBSERVATION_LEN..].copy_from_slice(&self.report.target);
    }
}

fn blend_at(position: GraphPosition) -> Blend {
    Blend::between(position.from, position.to, position.t)
}

fn is_valid(blend: &Blend, policies: usize) -> bool {
    let terms = blend.terms();
    !terms.is_empty() && terms.iter().all(|t| t.policy < policies && t.weights.iter().all(|w| w.is_finite()))
}
