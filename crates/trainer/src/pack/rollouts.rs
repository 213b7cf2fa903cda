//! What discriminators see in a game: rollouts of a pack's episodic skills, from before they start until after they hand over.

use std::sync::Arc;

use glam::Vec2;
use physics_bridge::{Character, Model, WALKING_START_MPS};
use policy_core::training::{FrameHistory, TARGET_RANGE_METRES, discriminator_frame_into};
use policy_core::{
    CharacterPack, CharacterState, Command, Controller, ControllerConfig, Goal, Heading, NodeId, SkillId,
};
use rayon::prelude::*;

use random::Rng;
use random::limp::{go_limp, lift_anyhow};

/// Seconds at the entry node before a skill starts, of lying limp before a recovery, and after the hand-over.
const BEFORE_SECS: f32 = 2.0;
const AFTER_SECS: f32 = 2.0;

/// Seconds of a whole rollout at most.
const MOST_SECS: f32 = 14.0;

/// Normalised discriminator inputs of every tick of so many rollouts of a skill, `[ticks][inputs]`.
pub(super) fn inputs(model: &Model, pack: &Arc<CharacterPack>, skill: SkillId, episodes: usize) -> Vec<f32> {
    let each = (0..episodes as u64).into_par_iter().map(|seed| Rollout::new(model, pack, skill, seed).run());
    each.collect::<Vec<_>>().concat()
}

/// One rollout.
struct Rollout {
    pack: Arc<CharacterPack>,
    skill: SkillId,
    character: Character,
    controller: Controller,
    state: CharacterState,
    history: FrameHistory,
    rng: Rng,
    rows: Vec<f32>,
    dt_secs: f32,
}

impl Rollout {
    fn new(model: &Model, pack: &Arc<CharacterPack>, skill: SkillId, seed: u64) -> Self {
        let mut rng = Rng::new(seed, 41);
        let known = &pack.skills()[skill.index()];
        let start = match known.entry.len() {
            0 => known.returns_to,
            count => known.entry[rng.index(count)],
        };
        let config = ControllerConfig {
            auto_recover: false,
            assist_rise: false,
            start,
            ..ControllerConfig::unassisted()
        };
        let skeleton = pack.skeleton();
        Self {
            skill,
            character: Character::new(model),
            controller: Controller::with_config(pack.clone(), config),
            state: CharacterState::new(skeleton),
            history: FrameHistory::new(skeleton.frame_len()),
            rng,
            rows: Vec::new(),
            dt_secs: 1.0 / pack.control_hz(),
            pack: pack.clone(),
        }
    }

    /// The rows of the rollout; those until the physics diverges, if it does.
    fn run(mut self) -> Vec<f32> {
        let known = self.pack.skills()[self.skill.index()].clone();
        let entry = self.controller.config().start;
        let begun =
            if self.pack.recovery() == Some(self.skill) { self.drop_limp() } else { self.walk(entry) };
        if begun.is_none() {
            return self.rows;
        }
        let mut asked = Some(self.skill);
        let mut left_secs = MOST_SECS;
        let mut ended = false;
        while left_secs > 0.0 {
            let target = Some(self.ahead());
            let command = Command {
                target,
                goal: Goal::Node(known.returns_to),
                skill: asked.take(),
                ..Command::default()
            };
            if self.tick(&command).is_none() {
                break;
            }
            left_secs -= self.dt_secs;
            if !ended && self.controller.report().skill_ended.is_some() {
                ended = true;
                left_secs = left_secs.min(AFTER_SECS);
            }
        }
        self.rows
    }

    /// A point straight ahead along x.
    fn ahead(&self) -> Vec2 {
        self.state.root().position.truncate() + Vec2::new(TARGET_RANGE_METRES, 0.0)
    }

    /// Acts at a node for a while; `None` when the physics diverged.
    fn walk(&mut self, node: NodeId) -> Option<()> {
        let stands = self.pack.graph().node(node).stands();
        let speed = if stands { 0.0 } else { self.rng.range(0.5, 1.0) * WALKING_START_MPS };
        self.character.stand_at(0.0, 0.0, Heading::FORWARD, speed).ok()?;
        self.character.sense_into(&mut self.state);
        let ticks = (BEFORE_SECS * self.rng.range(0.3, 1.0) / self.dt_secs) as usize;
        for _ in 0..ticks {
            let target = (!stands).then(|| self.ahead());
            self.tick(&Command { target, goal: Goal::Node(node), ..Command::default() })?;
        }
        Some(())
    }

    /// Drops the character in a random attitude with loose joints; `None` when the physics diverged.
    fn drop_limp(&mut self) -> Option<()> {
        lift_anyhow(&mut self.character, Vec2::ZERO, &mut self.rng).ok()?;
        for _ in 0..(BEFORE_SECS / self.dt_secs) as usize {
            go_limp(&mut self.character);
            self.character.step().ok()?;
            self.character.sense_into(&mut self.state);
            self.record();
        }
        Some(())
    }

    /// One control tick; `None` when the physics diverged.
    fn tick(&mut self, command: &Command) -> Option<()> {
        let targets = self.controller.tick(&self.state, command, self.dt_secs);
        self.character.actuate(targets);
        self.character.step().ok()?;
        self.character.sense_into(&mut self.state);
        self.record();
        Some(())
    }

    /// Adds the row of what is sensed now.
    fn record(&mut self) {
        let frame = self.history.push();
        discriminator_frame_into(self.pack.skeleton(), &self.state, frame);
        self.pack.tensors().discriminator_normaliser.normalise_in_place(frame);
        let at = self.rows.len();
        self.rows.resize(at + self.pack.skeleton().discriminator_input_len(), 0.0);
        if !self.history.input_into(&mut self.rows[at..]) {
            self.rows.truncate(at);
        }
    }
}
