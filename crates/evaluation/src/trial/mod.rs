//! One character under its controller, steered through [`CommandMapper`] as a pad would steer it.
//!
//! A measure settles a character in a gait, then acts: it moves the stick, presses a button or pushes the body.

mod disturbance;
mod gait;
mod low_pass;
mod settled;
mod statistics;

use std::sync::Arc;

use glam::Vec2;
use physics::{Character, Model, PhysicsCharacter};
use policy_core::contract::{CONTROL_HZ, WALKING_START_MPS};
use policy_core::{
    Bindings, CharacterPack, CharacterState, Command, CommandMapper, Controller, ControllerConfig,
    GamepadState, Heading, JointTargets, SkillId,
};

use super::eval_character::is_upright;

pub use disturbance::Disturbance;
pub use gait::{Gait, GaitList, Gaits};
pub use low_pass::LowPass;
pub use settled::Settled;
pub use statistics::{mean, median, quantile};

/// Seconds of a control tick.
pub const TICK_SECS: f32 = 1.0 / CONTROL_HZ as f32;

/// A foot whose lowest point is higher is off the ground, metres.
pub(crate) const OFF_GROUND_METRES: f32 = 0.01;

/// Ticks in a time, rounded.
#[must_use]
pub fn ticks(secs: f32) -> u32 {
    (secs / TICK_SECS).round() as u32
}

/// A stick that points to a direction, radians from x, counter-clockwise, as far as `push` in [0, 1]; the camera looks along x.
pub(crate) fn stick_along(angle: f32, push: f32) -> [f32; 2] {
    [-push * angle.sin(), push * angle.cos()]
}

/// A character, its controller and the pad that steers it.
#[derive(Debug)]
pub struct Trial {
    /// The body.
    pub character: Character,
    /// What steers it.
    pub controller: Controller,
    /// What it senses now.
    pub state: CharacterState,
    /// The pad, as it is held now.
    pub pad: GamepadState,
    /// Where the player's camera looks; along world x at first.
    pub camera: Heading,
    /// Horizontal velocity of the pelvis, low-passed, metres per second.
    pub velocity: LowPass,
    /// What comes between the controller and the motors.
    pub disturbance: Disturbance,
    mapper: CommandMapper,
    asked_skill: Option<SkillId>,
    targets: JointTargets,
}

impl Trial {
    /// A character that walks along x, with the pad in the hold of `gait`.
    #[must_use]
    pub fn new(model: &Model, pack: &Arc<CharacterPack>, config: ControllerConfig, gait: &Gait) -> Self {
        let config = ControllerConfig { start: gait.start, ..config };
        let mut trial = Self {
            character: Character::new(model),
            controller: Controller::with_config(pack.clone(), config),
            state: CharacterState::new(pack.skeleton()),
            pad: gait.pad,
            camera: Heading::FORWARD,
            velocity: LowPass::default(),
            disturbance: Disturbance::default(),
            asked_skill: None,
            targets: JointTargets::new(pack.skeleton()),
            mapper: CommandMapper::new(pack, &Bindings::default()),
        };
        trial.place(Vec2::ZERO, 0.0);
        trial
    }

    /// Stands the character up at a place, metres, walking along a direction, radians from x.
    pub fn place(&mut self, place: Vec2, angle: f32) {
        self.controller.reset();
        let heading = Heading::from_angle(angle);
        let speed = if self.stands() { 0.0 } else { WALKING_START_MPS };
        self.character.stand_at(place.x, place.y, heading, speed).expect("places tried are finite");
        self.character.sense_into(&mut self.state);
        self.velocity = LowPass::at(speed * heading.direction());
    }

    /// True when the policy that the controller starts with stands still.
    fn stands(&self) -> bool {
        let node = self.controller.report().position.nearest_node();
        self.controller.pack().graph().node(node).stands()
    }

    /// Points the stick to a direction, radians from x, counter-clockwise, as far as `push` in [0, 1].
    pub fn steer(&mut self, angle: f32, push: f32) {
        self.pad.left_stick = stick_along(angle, push);
    }

    /// One control tick. False when the physics diverged.
    pub fn tick(&mut self) -> bool {
        self.tick_with(|_| {})
    }

    /// One control tick with a command that `change` has altered. False when the physics diverged.
    pub fn tick_with(&mut self, change: impl FnOnce(&mut Command)) -> bool {
        let mut command = self.mapper.map(&self.pad, self.camera, &self.state);
        change(&mut command);
        self.asked_skill = command.skill;
        self.targets.copy_from_slice(self.controller.tick(&self.state, &command, TICK_SECS));
        self.disturbance.apply(&mut self.targets);
        self.character.actuate(&self.targets);
        let sound = self.character.step().is_ok();
        self.character.sense_into(&mut self.state);
        self.velocity.tick(self.state.root().linear_velocity.truncate());
        sound
    }

    /// The skill that was asked for in the last tick.
    #[must_use]
    pub fn asked_skill(&self) -> Option<SkillId> {
        self.asked_skill
    }

    /// True when the character has fallen.
    #[must_use]
    pub fn is_down(&self) -> bool {
        self.controller.report().fallen
    }

    /// Horizontal place of the pelvis, metres.
    #[must_use]
    pub fn position(&self) -> Vec2 {
        self.state.root().position.truncate()
    }

    /// Height of the pelvis above the ground, metres.
    #[must_use]
    pub fn pelvis_height(&self) -> f32 {
        self.state.root_height()
    }

    /// Angle of the pelvis' heading from x, radians.
    #[must_use]
    pub fn heading(&self) -> f32 {
        Heading::from_rotation(self.state.root().rotation).angle()
    }

    /// Which way is ahead while a gait settles, radians from x: along x, where its stick points, or with the stick at rest where the character
    /// faces. It may have turned as it came to its stand.
    #[must_use]
    pub fn ahead(&self) -> f32 {
        if self.pad.left_stick == [0.0; 2] { self.heading() } else { 0.0 }
    }

    /// True when pelvis and head are as high as in standing.
    #[must_use]
    pub fn is_upright(&self) -> bool {
        is_upright(self.controller.pack().skeleton(), &self.state)
    }

    /// True when the graph position is where the controller is going.
    #[must_use]
    pub fn has_arrived(&self) -> bool {
        let report = self.controller.report();
        match report.goal.as_node() {
            Some(node) => report.position.as_node() == Some(node),
            None => {
                let t = report.goal.along(report.position.from, report.position.to);
                t.is_some_and(|t| (t - report.position.t).abs() < 1e-3)
            }
        }
    }
}
