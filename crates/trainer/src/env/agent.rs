//! One character that learns: its body, its command, its history and its episode.

use glam::Vec2;
use physics_bridge::{Character, Model};
use policy_core::{
    ActionScaling, Body, CharacterState, DISCRIMINATOR_INPUT_LEN, DOF_COUNT, FrameHistory, Heading,
    JointTargets, OBSERVATION_LEN, POLICY_INPUT_LEN, discriminator_frame_into, observe_into, target_input,
};

use self::imitate::{Imitated, own_clips};
use self::mishap::Mishaps;
use self::noise::Noise;
use super::command::{Command, DT_SECS};
use super::config::Task;
use super::fallen::{FallRule, stands};
use super::population::Stage;
use super::reward::{Manner, RewardTerms, standing_reward, target_reward};
use crate::Rng;
use crate::ppo::Done;

mod forces;
mod imitate;
mod mishap;
mod noise;
mod rise;
mod start;

pub use self::forces::PUSH_SECS;
pub use self::rise::Recovery;

/// What a finished episode was.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Episode {
    /// Its length.
    pub ticks: u32,
    /// True when it failed.
    pub failed: bool,
}

/// One character that learns.
#[derive(Debug)]
pub struct Agent {
    character: Character,
    /// What it senses now.
    pub state: CharacterState,
    /// What it is asked.
    pub command: Command,
    history: FrameHistory,
    rng: Rng,
    age: u32,
    /// Age at which the episode began.
    born_at: u32,
    place: (f64, f64),
    /// What it imitates, if anything.
    imitated: Option<Imitated>,
    /// True when it imitates the clips of every node that it rests at.
    imitator: bool,
    /// Ticks until it looks for the clip that it has lost.
    strayed_ticks: u32,
    mishaps: Mishaps,
    noise: Noise,
    /// Ticks of the episode in which it stood.
    stood_ticks: u32,
}

impl Agent {
    /// A character with its own random numbers; [`Agent::reset`] starts its first episode.
    #[must_use]
    pub fn new(model: &Model, rng: Rng) -> Self {
        Self {
            character: Character::new(model),
            state: CharacterState::default(),
            command: Command::default(),
            history: FrameHistory::default(),
            rng,
            age: 0,
            born_at: 0,
            place: (0.0, 0.0),
            imitated: None,
            imitator: false,
            strayed_ticks: 0,
            mishaps: Mishaps::default(),
            noise: Noise::default(),
            stood_ticks: 0,
        }
    }

    /// Starts an episode; the first one anywhere in its time, later ones up to a quarter of it short.
    pub fn reset(&mut self, stage: &Stage<'_>, first: bool) {
        let config = stage.config;
        // Random ages at the start, or a population without falls would end its episodes as one.
        let ticks = config.episode_ticks as usize;
        self.born_at = self.rng.index(if first { ticks } else { ticks.div_ceil(4) }) as u32;
        self.age = self.born_at;
        self.mishaps.begin();
        (self.stood_ticks, self.strayed_ticks) = (0, 0);
        let again = self.rng.chance(config.start.mishap) && self.start_before_failure(stage);
        self.noise = Noise::begin(config, again, &mut self.rng);
        if again {
            return;
        }
        self.choose_place();
        let risen = config.start.after.as_ref().map_or(0.0, |after| after.share);
        if self.rng.chance(risen) && self.start_risen(stage) {
            self.imitator = false;
            return;
        }
        self.imitator = self.rng.chance(config.imitators);
        self.command = Command::start(config, stage.course, self.imitator, &mut self.rng);
        let limp = self.rng.chance(config.start.ragdoll);
        let launched = !limp && self.rng.chance(config.start.launched);
        if launched {
            self.launch(stage);
        } else {
            self.start_in_clips(stage, limp);
        }
        let at = (self.position(), self.heading().angle());
        self.command.aim(config, stage.course, at, &mut self.rng);
        // Of skills trained together only imitators imitate.
        if limp || launched || config.imitation == 0.0 || (config.imitators > 0.0 && !self.imitator) {
            self.imitated = None;
        }
    }

    fn push_frame(&mut self, stage: &Stage<'_>) {
        let slot = self.history.push();
        discriminator_frame_into(&self.state, slot);
        stage.normalisers.frame.normalise_in_place(slot);
    }

    /// Horizontal place of the pelvis.
    #[must_use]
    pub fn position(&self) -> Vec2 {
        self.state.body(Body::Pelvis).position.truncate()
    }

    fn heading(&self) -> Heading {
        Heading::from_rotation(self.state.body(Body::Pelvis).rotation)
    }

    /// Writes the normalised observation and the target: a policy's input.
    ///
    /// # Panics
    /// When `out` is not [`POLICY_INPUT_LEN`] long.
    pub fn input_into(&self, stage: &Stage<'_>, out: &mut [f32]) {
        assert_eq!(out.len(), POLICY_INPUT_LEN, "input of a policy");
        let (observation, target) = out.split_at_mut(OBSERVATION_LEN);
        let observation: &mut [f32; OBSERVATION_LEN] = observation.try_into().expect("split at its length");
        observe_into(&self.state, observation);
        stage.normalisers.observation.normalise_in_place(observation);
        target.copy_from_slice(&target_input(&self.state, self.command.target));
    }

    /// Acts for one tick, writes the discriminator's input afterwards and tells what the tick was worth and how it
    /// ended. The caller resets the character when it ended.
    pub fn step(
        &mut self,
        stage: &Stage<'_>,
        scaling: &ActionScaling,
        action: &[f32; DOF_COUNT],
        discriminator_input: &mut [f32; DISCRIMINATOR_INPUT_LEN],
    ) -> (RewardTerms, Done) {
        let config = stage.config;
        let before = self.position();
        let mut targets = JointTargets::default();
        scaling.targets_into(action, &mut targets);
        self.character.actuate(&targets);
        self.push(config);
        let diverged = self.character.step().is_err();
        self.character.sense_into(&mut self.state);
        self.push_frame(stage);
        self.history.input_into(discriminator_input);
        self.age += 1;
        self.stood_ticks += u32::from(stands(&self.state));
        let velocity = (self.position() - before) / DT_SECS;
        let place = self.command.place;
        let manner = Manner {
            speed_mps: stage.course.speed_mps(place),
            least_width_mps: stage.course.least_width_mps(place),
            strict_facing: config.strict_facing,
        };
        let height = (config.height, stage.course.pelvis_metres(place));
        let terms = match config.task {
            Task::Target if self.command.is_late() => RewardTerms::default(),
            Task::Target => target_reward(&self.state, velocity, self.command.target, manner)
                .with_height(&self.state, height),
            Task::Stand => standing_reward(&self.state),
        };
        let slides = config.slide_cost > 0.0 && stage.course.fall(place).is_upright();
        let terms = if slides { self.with_slide(terms) } else { terms };
        if diverged || !self.state.is_finite() || self.has_fallen(stage) {
            if !diverged && self.state.is_finite() {
                self.mishaps.failed(&mut self.rng);
            }
            return (terms, Done::Failed);
        }
        if self.command.stuck() {
            // Not a fall: who fears the way up so much does not go down either.
            self.mishaps.failed(&mut self.rng);
            return (terms, Done::TimedOut);
        }
        if config.start.mishap > 0.0 && self.mishaps.tick() {
            self.mishaps.keep(&self.character, &self.history, self.command);
        }
        let (imitation, lost) =
            if self.imitator { (self.imitate_node(stage), Done::No) } else { self.imitate(stage) };
        let old = self.age >= config.episode_ticks;
        (RewardTerms { imitation, ..terms }, if lost == Done::No && old { Done::TimedOut } else { lost })
    }

    /// Renews target and place on the course, after the tick's reward.
    pub fn advance_command(&mut self, stage: &Stage<'_>) {
        let position = self.position();
        let low = |rule: FallRule| rule.is_broken_by(&self.state, true);
        self.command.advance(stage.config, stage.course, position, low, &mut self.rng);
        self.noise.tick(stage.config, &mut self.rng);
    }

    /// True while it is to act by the policy's mean, without noise.
    #[must_use]
    pub fn is_quiet(&self) -> bool {
        self.noise.is_quiet()
    }

    /// Length of the episode so far and whether it failed.
    #[must_use]
    pub fn episode(&self, done: Done) -> Episode {
        Episode { ticks: self.age - self.born_at, failed: done == Done::Failed }
    }

    fn has_fallen(&self, stage: &Stage<'_>) -> bool {
        stage.course.fall(self.command.place).is_broken_by(&self.state, self.stood_ticks >= STOOD_TICKS)
    }
}

/// Ticks after which a character counts as one that has stood.
const STOOD_TICKS: u32 = 5;
