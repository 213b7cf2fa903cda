//! The character that is met. A controller of skills that are trained already drives it.

use glam::Vec2;
use physics_bridge::{CharacterHandle, World};
use policy_core::{CharacterState, Command, Controller, Goal, Heading};

use super::super::command::DT_SECS;

/// The node at which it walks.
pub(crate) const WALK: &str = "walk";

/// The gaits that its controller has.
pub(crate) const MET: [&str; 2] = ["idle", WALK];

/// How far ahead of it its target lies, metres.
const TARGET_METRES: f32 = 5.0;

/// The character that is met.
#[derive(Debug)]
pub(super) struct Other {
    handle: CharacterHandle,
    controller: Controller,
    state: CharacterState,
    walk: Goal,
    /// The direction in which it walks; `None` while it stands by.
    pub way: Option<Vec2>,
}

impl Other {
    /// A character of a world that stands by. Allocates.
    pub fn new(handle: CharacterHandle, controller: &Controller) -> Self {
        let pack = controller.pack();
        Self {
            handle,
            state: CharacterState::new(pack.skeleton()),
            walk: pack.graph().node_named(WALK).map_or(Goal::Stay, Goal::Node),
            controller: controller.clone(),
            way: None,
        }
    }

    /// Stands it somewhere else; all of it moves along `angle`, radians from x.
    pub fn stand(&mut self, world: &mut World, at: Vec2, angle: f32, speed_mps: f32) {
        let heading = Heading::from_angle(angle);
        world.stand_at(self.handle, at.x, at.y, heading, speed_mps).expect("a place near the character");
        self.controller.reset();
    }

    /// Senses and acts for a tick.
    pub fn act(&mut self, world: &mut World) {
        world.sense_into(self.handle, &mut self.state).expect("it is never removed");
        let at = self.state.root().position.truncate();
        let target = self.way.map(|way| at + TARGET_METRES * way);
        let command = Command { target, goal: self.walk, ..Command::default() };
        let targets = self.controller.tick(&self.state, &command, DT_SECS);
        world.actuate(self.handle, targets).expect("it is never removed");
    }
}
