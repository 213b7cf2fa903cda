//! One environment: a character with its body, command, history and episode. An environment is stepped with an action and
//! returns reward terms and how the tick ended.

use glam::Vec2;
use physics_bridge::{Character, Contact, Model};
use policy_core::training::{ActionScaling, FrameHistory, Heights, discriminator_frame_into};
use policy_core::{BodyId, CharacterState, Controller, Heading, JointTargets, Skeleton};
use random::Rng;

use super::averaged::AveragedVelocity;
use super::command::{Command, DT_SECS};
use super::config::EnvironmentConfig;
use super::demonstrations::Demonstrations;
use super::exploration::Exploration;
use super::graph::TrainingGraph;
use super::meetings::Company;
use super::normalisers::Normalisers;
use super::reset::{HandOver, PlayedStarts, PreFailureStates};
use super::reward::{Pace, RewardTerms, Task, foot_slip_mps, paid_velocity, standing_reward, target_reward};
use super::termination::TerminationHeights;
use super::track_clip::Tracking;
use crate::ppo::Done;

/// What all environments share in a phase of training.
#[derive(Clone, Copy, Debug)]
pub struct EnvContext<'a> {
    /// Settings.
    pub config: &'a EnvironmentConfig,
    /// The character's bodies and joints.
    pub skeleton: &'a Skeleton,
    /// What characters move along.
    pub graph: &'a TrainingGraph,
    /// Clips of the graph's nodes.
    pub demonstrations: &'a [&'a Demonstrations],
    /// Other clips, for starts.
    pub start_demonstrations: Option<&'a Demonstrations>,
    /// Episodic skills whose ends are starts, in the order of the recipe.
    pub hand_over: &'a [HandOver],
    /// Means and deviations of the whole graph.
    pub normalisers: &'a Normalisers,
    /// Heights that tell standing from lying.
    pub heights: &'a TerminationHeights,
    /// Bodies that are pushed.
    pub pushed: &'a [BodyId],
    /// What drives the characters that are met, and a character until a skill starts in play; `None` where there is neither.
    pub company: Option<&'a Controller>,
}

/// A finished episode.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Episode {
    /// Its length.
    pub ticks: u32,
    /// True when it failed.
    pub failed: bool,
}

/// One environment.
#[derive(Debug)]
pub struct Env {
    pub(super) character: Character,
    /// The world in which it meets others, where it does. `character` is then only what episodes start from.
    pub(super) company: Option<Box<Company>>,
    /// What the character senses now.
    pub state: CharacterState,
    /// What it is told to do.
    pub command: Command,
    pub(super) history: FrameHistory,
    pub(super) rng: Rng,
    pub(super) age: u32,
    /// Age at which the episode began.
    pub(super) born_at: u32,
    /// Horizontal position of the next start, metres.
    pub(super) ground_position: (f64, f64),
    /// What it tracks, if anything.
    pub(super) tracking: Option<Tracking>,
    /// True when it tracks the clips of every node that it rests at.
    pub(super) tracker: bool,
    /// Ticks until it may track again.
    pub(super) lost_ticks: u32,
    pub(super) pre_failure: PreFailureStates,
    /// Starts in play.
    pub(super) played: PlayedStarts,
    pub(super) exploration: Exploration,
    /// Where it faced when the episode began, world, of unit length.
    pub(super) faced_first: Vec2,
    /// The velocity that is paid for, over the episode.
    pub(super) averaged: AveragedVelocity,
    /// Ticks of the episode in which it stood.
    pub(super) stood_ticks: u32,
    /// True when actions arrive one tick late in this episode.
    pub(super) delayed: bool,
    /// Targets of the last action, which a delayed character gets now; those of the action before.
    pub(super) targets: [JointTargets; 2],
    /// True once the episode has targets of an action before.
    pub(super) has_late_targets: bool,
}

/// Ticks after which a character counts as one that has stood.
const STOOD_TICKS: u32 = 5;

/// Standard gravity, metres per second squared.
pub(super) const GRAVITY: f32 = 9.81;

impl Env {
    /// An environment with its own random numbers; [`Env::reset`] starts its first episode.
    #[must_use]
    pub fn new(model: &Model, context: &EnvContext<'_>, mut rng: Rng) -> Self {
        let skeleton = model.skeleton();
        let share = context.config.meetings.share;
        let meets = context.company.filter(|_| share > 0.0 && rng.chance(share));
        let company = meets.map(|controller| {
            Box::new(Company::new(model, controller, &mut rng).expect("a world of a model that was loaded"))
        });
        let targets = JointTargets::new(skeleton);
        Self {
            character: Character::new(model),
            company,
            state: CharacterState::new(skeleton),
            command: Command::default(),
            history: FrameHistory::new(skeleton.frame_len()),
            rng,
            age: 0,
            born_at: 0,
            ground_position: (0.0, 0.0),
            tracking: None,
            tracker: false,
            lost_ticks: 0,
            pre_failure: PreFailureStates::default(),
            played: PlayedStarts::new(),
            exploration: Exploration::default(),
            faced_first: Vec2::X,
            averaged: AveragedVelocity::default(),
            stood_ticks: 0,
            delayed: false,
            targets: [targets.clone(), targets],
            has_late_targets: false,
        }
    }

    pub(super) fn push_frame(&mut self, context: &EnvContext<'_>) {
        let slot = self.history.push();
        discriminator_frame_into(context.skeleton, &self.state, slot);
        context.normalisers.frame.normalise_in_place(slot);
    }

    /// Horizontal position of the root, metres.
    #[must_use]
    pub fn root_position(&self) -> Vec2 {
        self.state.root().position.truncate()
    }

    pub(super) fn heading(&self) -> Heading {
        Heading::from_rotation(self.state.root().rotation)
    }

    /// Acts for one tick and writes the discriminator's input afterwards. Returns what the tick was worth and how it ended.
    /// The caller resets the environment when the episode ended.
    ///
    /// # Panics
    /// When the lengths of action or input are not those of the skeleton.
    pub fn step(
        &mut self,
        context: &EnvContext<'_>,
        scaling: &ActionScaling,
        action: &[f32],
        discriminator_input: &mut [f32],
    ) -> (RewardTerms, Done) {
        let config = context.config;
        let before = self.root_position();
        let diverged = self.act(context, scaling, action);
        self.sense();
        self.push_frame(context);
        self.history.input_into(discriminator_input);
        self.age += 1;
        self.stood_ticks += u32::from(context.heights.stands(&self.state));
        let velocity = (self.root_position() - before) / DT_SECS;
        let velocity = paid_velocity(&config.reward, context.skeleton, &self.state, velocity);
        let velocity = self.averaged.tick(velocity, config.reward.averaging_secs);
        let terms = self.reward(context, velocity);
        if diverged || !self.state.is_finite() || self.has_failed(context) {
            if !diverged && self.state.is_finite() {
                self.pre_failure.failed(&mut self.rng);
            }
            return (terms, Done::Failed);
        }
        if self.command.stuck() {
            // Truncated, not failed: a policy that fears standing up would no longer go down either.
            self.pre_failure.failed(&mut self.rng);
            return (terms, Done::TimedOut);
        }
        if config.reset.pre_failure_share > 0.0 && self.pre_failure.tick() {
            if let Some(company) = &mut self.company {
                company.copy_to(&mut self.character);
            }
            self.pre_failure.keep(&self.character, &self.history, self.command);
        }
        let (tracking, lost) =
            if self.tracker { (self.track_node(context), Done::No) } else { self.track_clip(context) };
        let old = self.age >= config.episode_ticks;
        (RewardTerms { tracking, ..terms }, if lost == Done::No && old { Done::TimedOut } else { lost })
    }

    /// Actuates and steps; true when the physics diverged.
    fn act(&mut self, context: &EnvContext<'_>, scaling: &ActionScaling, action: &[f32]) -> bool {
        self.push(context);
        let [now, before] = &mut self.targets;
        std::mem::swap(now, before);
        scaling.targets_into(action, now);
        let late = self.delayed && self.has_late_targets;
        let targets = if late { before } else { now };
        self.has_late_targets = true;
        if let Some(company) = &mut self.company {
            return company.step(targets, &self.state, context.config.meetings.pause_secs, &mut self.rng);
        }
        self.character.actuate(targets);
        self.character.step().is_err()
    }

    /// Senses where it is stepped.
    fn sense(&mut self) {
        match &self.company {
            Some(company) => company.sense_into(&mut self.state),
            None => self.character.sense_into(&mut self.state),
        }
    }

    /// Where it touches.
    fn contacts(&self) -> &[Contact] {
        self.company.as_ref().map_or(self.character.contacts(), |company| company.contacts())
    }

    /// Reward terms of a tick for the velocity that is paid for, without tracking.
    pub(super) fn reward(&self, context: &EnvContext<'_>, velocity: Vec2) -> RewardTerms {
        let (config, graph, position) = (&context.config.reward, context.graph, self.command.position);
        let prompt_mps = if config.prompt_start { self.command.prompt_mps(graph) } else { 0.0 };
        let pace = Pace {
            speed_mps: self.command.speed_mps(graph, self.root_position()).max(prompt_mps),
            speed_scale_mps: graph.speed_scale_mps(position),
            facing: match self.command.facing() {
                Some(facing) => Some((facing, graph.strafe(position).0)),
                None if self.command.stop => Some((self.faced_first, config.kept_facing_share)),
                None => None,
            },
        };
        let height = (config.height_share, graph.root_metres(position));
        let terms = match config.task {
            Task::Target if self.command.is_late() => RewardTerms::default(),
            Task::Target => target_reward(config, &self.state, velocity, self.command.target, pace)
                .with_height(&self.state, height),
            Task::Stand => standing_reward(config, context.skeleton, &self.state),
        };
        if config.foot_slip_cost == 0.0 || !graph.termination(position).is_upright() {
            return terms;
        }
        let weight = self.character.model().mass_kg() as f32 * GRAVITY;
        let foot_slip_mps = foot_slip_mps(
            context.skeleton.feet(),
            &self.state,
            self.contacts(),
            weight,
            config.foot_slip_most_mps,
        );
        RewardTerms { foot_slip_mps, ..terms }
    }

    /// Renews target and position on the graph, after the tick's reward.
    pub fn advance_command(&mut self, context: &EnvContext<'_>) {
        let heights = Heights::of(context.skeleton, &self.state);
        self.command.advance(&context.config.command, context.graph, &self.state, heights, &mut self.rng);
        self.exploration.tick(&context.config.exploration, &mut self.rng);
    }

    /// True while it should act by the policy's mean, without noise.
    #[must_use]
    pub fn is_deterministic(&self) -> bool {
        self.exploration.is_deterministic()
    }

    /// Length of the episode so far and whether it failed.
    #[must_use]
    pub fn episode(&self, done: Done) -> Episode {
        Episode { ticks: self.age - self.born_at, failed: done == Done::Failed }
    }

    pub(super) fn has_failed(&self, context: &EnvContext<'_>) -> bool {
        let rule = context.graph.termination(self.command.position);
        rule.is_broken_by(context.heights, &self.state, self.stood_ticks >= STOOD_TICKS)
            || self.command.faces_elsewhere(context.graph, self.heading())
    }
}
