//! One player of an arena: controller, command mapping, and what its character last sensed.

use std::sync::Arc;

use policy_core::glam::{Vec2, Vec3};
use policy_core::{
    Bindings, BodyId, Button, Buttons, CharacterPack, CharacterState, Command, CommandMapper, Controller,
    ControllerState, Heading, TickReport,
};
use replay::{Pad, StateHash};

/// Force of a shove, newtons, and its length, seconds: more than any gait survives. Ones of 1200 and 1400 N were survived after a roll.
const SHOVE_NEWTON: f32 = 1800.0;
const SHOVE_SECS: f32 = 0.2;
/// A root below this share of its height at the start belongs to a character that lies.
const LYING: f32 = 0.3;
/// A faster character is not shoved, metres per second: shoves must not add up.
const SHOVED_BELOW_MPS: f32 = 5.0;
/// Seconds after which a character without a skill to get up is stood up.
const LIE_SECS: f32 = 2.0;

/// What a player's character does, to draw and to tell it.
#[derive(Clone, Copy, Debug)]
pub struct PlayerView<'a> {
    /// What it sensed after the last tick.
    pub state: &'a CharacterState,
    /// What its controller did in the last tick.
    pub report: &'a TickReport,
}

#[derive(Debug)]
pub(crate) struct Player {
    controller: Controller,
    mapper: CommandMapper,
    /// Room for the controller's state, while it is hashed or saved.
    saved: ControllerState,
    pub(crate) state: CharacterState,
    /// Where it starts, metres, and where it looks there.
    pub(crate) start: (Vec2, Heading),
    /// The pad of the last tick: buttons act when they go down.
    last_pad: Pad,
    /// How long it has lain without a skill to get up.
    down_secs: f32,
    shoved: BodyId,
    /// Height of the root that counts as lying, metres.
    lying_m: f32,
}

/// What changes of a player from tick to tick.
#[derive(Clone, Debug)]
pub(crate) struct PlayerState {
    controller: ControllerState,
    state: CharacterState,
    last_pad: Pad,
    down_secs: f32,
}

impl Player {
    pub(crate) fn new(pack: &Arc<CharacterPack>, at: Vec2, heading: Heading) -> Self {
        let skeleton = pack.skeleton();
        Self {
            controller: Controller::new(Arc::clone(pack)),
            mapper: CommandMapper::new(pack, &Bindings::default()),
            saved: ControllerState::new(pack),
            state: CharacterState::new(skeleton),
            start: (at, heading),
            last_pad: Pad::default(),
            down_secs: 0.0,
            shoved: skeleton.head().and_then(|head| skeleton.parent(head)).unwrap_or(skeleton.root()),
            lying_m: 0.0,
        }
    }

    /// Height of a root that lies, once the character stands.
    pub(crate) fn stands(&mut self) {
        self.lying_m = LYING * self.state.root_height();
    }

    pub(crate) fn view(&self) -> PlayerView<'_> {
        PlayerView { state: &self.state, report: self.controller.report() }
    }

    /// True when a button goes down.
    pub(crate) fn presses(&self, pad: Pad, button: Button) -> bool {
        let held = |pad: Pad| -> Buttons { pad.state().buttons };
        held(pad).pressed_since(held(self.last_pad)).contains(button)
    }

    /// The joint targets of a tick under a pad.
    pub(crate) fn decide(&mut self, pad: Pad, dt_secs: f32) -> &[f32] {
        let command = self.mapper.map(&pad.state(), pad.heading(), &self.state);
        self.last_pad = pad;
        self.controller.tick(&self.state, &command, dt_secs)
    }

    /// The joint targets of a tick under a command of its own.
    pub(crate) fn follow(&mut self, command: &Command, dt_secs: f32) -> &[f32] {
        self.controller.tick(&self.state, command, dt_secs)
    }

    /// The push of a shove; `None` for a character that lies or flies.
    pub(crate) fn shoved_along(&self, direction: Vec2) -> Option<(BodyId, Vec3, f32)> {
        let root = self.state.root();
        let stands =
            self.state.root_height() > self.lying_m && root.linear_velocity.length() < SHOVED_BELOW_MPS;
        stands.then(|| (self.shoved, (direction * SHOVE_NEWTON).extend(0.0), SHOVE_SECS))
    }

    /// True from a fall until it is on its feet again.
    pub(crate) fn is_down(&self) -> bool {
        self.controller.is_down()
    }

    /// True when it has lain too long and no skill gets it up.
    pub(crate) fn lies_for_good(&mut self, dt_secs: f32) -> bool {
        let report = self.controller.report();
        let helpless = report.fallen && report.skill.is_none() && report.pending_skill.is_none();
        self.down_secs = if helpless { self.down_secs + dt_secs } else { 0.0 };
        self.down_secs >= LIE_SECS
    }

    /// Begins anew: the character was put back to its start.
    pub(crate) fn stood_up(&mut self) {
        self.controller.reset();
        self.down_secs = 0.0;
    }

    pub(crate) fn hash_into(&mut self, hash: &mut StateHash, scratch: &mut Vec<u8>) {
        self.controller.save_into(&mut self.saved);
        scratch.resize(self.saved.byte_len(), 0);
        self.saved.write_bytes(scratch);
        hash.bytes(scratch);
        hash.bytes(&self.last_pad.to_bytes());
        hash.floats(&[self.down_secs]);
    }

    pub(crate) fn save(&self) -> PlayerState {
        let mut controller = self.saved.clone();
        self.controller.save_into(&mut controller);
        PlayerState {
            controller,
            state: self.state.clone(),
            last_pad: self.last_pad,
            down_secs: self.down_secs,
        }
    }

    /// True when a state can be restored.
    pub(crate) fn fits(&self, saved: &PlayerState) -> bool {
        saved.state.bodies.len() == self.state.bodies.len()
            && saved.controller.byte_len() == self.saved.byte_len()
    }

    /// Goes back to a saved state.
    ///
    /// # Errors
    /// When the controller refuses its part.
    pub(crate) fn restore(&mut self, saved: &PlayerState) -> Result<(), policy_core::StateError> {
        self.controller.restore(&saved.controller)?;
        self.state.clone_from(&saved.state);
        (self.last_pad, self.down_secs) = (saved.last_pad, saved.down_secs);
        // The mapper remembers the buttons of the pad that it mapped last.
        self.mapper.map(&saved.last_pad.state(), saved.last_pad.heading(), &self.state);
        Ok(())
    }
}
