//! One character as the demo keeps it: controller, command, the last two poses and its sums.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::Vec2;
use physics_bridge::{BodyPoses, Character};
use policy_core::{
    Arithmetic, Body, CharacterPack, CharacterState, Command, Controller, ControllerConfig, Heading,
    JointTargets, TickReport,
};

use super::{SHOVED_BELOW_MPS, TICK_SECS, Totals};

/// A torso that is lower lies, metres above the ground; a crawl is higher.
const SHOVED_ABOVE_M: f32 = 0.3;

/// Reports kept for going back.
const KEPT_REPORTS: usize = 301;

/// A character's mind and what is known of its motion.
#[derive(Clone, Debug)]
pub struct Actor {
    /// Steers it.
    pub controller: Controller,
    /// What it sensed after the last tick.
    pub state: CharacterState,
    /// What it was asked in the last tick.
    pub command: Command,
    /// Seconds it has lain with no skill to rise.
    pub(super) lay_secs: f32,
    /// Seconds that the last shove still acts.
    pub(super) shoved_secs: f32,
    /// Time its controller took in the last tick.
    pub(super) policy_time: Duration,
    poses: [BodyPoses; 2],
    reports: VecDeque<TickReport>,
    was_down: bool,
    /// Ticks it was taken back and has not gone on from.
    age: usize,
}

impl Actor {
    pub(super) fn new(pack: Arc<CharacterPack>, character: &Character) -> Self {
        let config = ControllerConfig { arithmetic: Arithmetic::Reproducible, ..ControllerConfig::default() };
        let mut actor = Self {
            controller: Controller::with_config(pack, config),
            state: CharacterState::default(),
            command: Command::default(),
            lay_secs: 0.0,
            shoved_secs: 0.0,
            policy_time: Duration::ZERO,
            poses: [BodyPoses::default(); 2],
            reports: VecDeque::with_capacity(KEPT_REPORTS),
            was_down: false,
            age: 0,
        };
        actor.restart(character);
        actor
    }

    /// What the controller did in the last tick.
    #[must_use]
    pub fn report(&self) -> &TickReport {
        self.controller.report()
    }

    /// Where the pelvis is, seen from above.
    #[must_use]
    pub fn position(&self) -> Vec2 {
        self.state.body(Body::Pelvis).position.truncate()
    }

    /// Where it looks.
    #[must_use]
    pub fn heading(&self) -> Heading {
        Heading::from_rotation(self.state.body(Body::Pelvis).rotation)
    }

    /// Horizontal speed of the pelvis, metres per second.
    #[must_use]
    pub fn speed(&self) -> f32 {
        self.state.body(Body::Pelvis).linear_velocity.truncate().length()
    }

    /// True while it lies or rises.
    #[must_use]
    pub fn is_down(&self) -> bool {
        let report = self.report();
        let recovery = self.controller.pack().recovery();
        report.fallen || (recovery.is_some() && report.skill.map(|s| s.skill) == recovery)
    }

    /// False while a shove acts, and for a body that is down or fast.
    pub(super) fn can_be_shoved(&self) -> bool {
        let torso = self.state.body(Body::Torso);
        let fast = torso.linear_velocity.length() > SHOVED_BELOW_MPS;
        let down = torso.position.z - self.state.ground_height < SHOVED_ABOVE_M;
        self.shoved_secs <= 0.0 && !fast && !down && !self.is_down()
    }

    /// Poses `alpha` of the way from the last tick but one to the last.
    #[must_use]
    pub fn poses(&self, alpha: f32) -> BodyPoses {
        interpolated(&self.poses[0], &self.poses[1], alpha)
    }

    /// Takes the player's command; the target moves along, so that a crowd keeps its order.
    pub(super) fn receive(&mut self, command: &Command, player: Vec2) {
        self.command = *command;
        self.command.target = command.target.map(|t| t - player + self.position());
    }

    pub(super) fn steer(&mut self, state: &CharacterState, targets: &mut JointTargets) {
        let start = Instant::now();
        *targets = *self.controller.tick(state, &self.command, TICK_SECS);
        self.policy_time = start.elapsed();
    }

    /// Takes in what a tick of physics did.
    pub(super) fn observe(&mut self, character: &Character, totals: &mut Totals) {
        let before = self.position();
        self.take_pose(character);
        let report = *self.report();
        // What came after the state it was taken back to is forgotten.
        self.reports.truncate(self.reports.len().saturating_sub(std::mem::take(&mut self.age)).max(1));
        if self.reports.len() == KEPT_REPORTS {
            self.reports.pop_front();
        }
        self.reports.push_back(report);
        let down = self.is_down();
        totals.tick(before.distance(self.position()), down, down && !self.was_down);
        self.was_down = down;
        let helpless = down && self.controller.pack().recovery().is_none();
        self.lay_secs = if helpless { self.lay_secs + TICK_SECS } else { 0.0 };
        self.shoved_secs = (self.shoved_secs - TICK_SECS).max(0.0);
        totals.hash.absorb(&character.pose());
    }

    /// Begins anew where the character was put.
    pub(super) fn restart(&mut self, character: &Character) {
        self.controller.reset();
        self.reports.clear();
        self.reports.push_back(*self.controller.report());
        (self.lay_secs, self.shoved_secs, self.was_down, self.age) = (0.0, 0.0, false, 0);
        self.take_pose(character);
        self.poses[0] = self.poses[1];
    }

    /// Goes back with the character, `age` ticks before the newest.
    pub(super) fn rewind_to(&mut self, age: usize, character: &Character) {
        if let Some(report) = self.reports.len().checked_sub(age + 1).and_then(|i| self.reports.get(i)) {
            self.controller.place_at(report.position);
        }
        self.age = age;
        self.take_pose(character);
        self.poses[0] = self.poses[1];
    }

    fn take_pose(&mut self, character: &Character) {
        character.sense_into(&mut self.state);
        self.poses[0] = self.poses[1];
        character.poses_into(&mut self.poses[1]);
    }
}

/// Poses `alpha` of the way from `a` to `b`.
#[must_use]
pub fn interpolated(a: &BodyPoses, b: &BodyPoses, alpha: f32) -> BodyPoses {
    let mut poses = *b;
    for i in 0..poses.positions.len() {
        poses.positions[i] = a.positions[i].lerp(b.positions[i], alpha);
        poses.rotations[i] = a.rotations[i].slerp(b.rotations[i], alpha);
    }
    poses
}
