//! The world of the demo: characters in the physics, each with its controller. One path for the window and
//! for runs without one. Knows nothing of drawing, devices or panels.

mod actor;
mod error;
mod ghost;
mod playback;
mod queries;
mod setup;
mod totals;

use std::sync::Arc;
use std::time::{Duration, Instant};

use physics_bridge::{Crowd, Diverged, Dump, Model, Settings};
use policy_core::{
    Blend, BlendMode, Body, Button, Buttons, CharacterPack, Command, CommandMapper, GamepadState, Goal,
    GraphPosition, Heading,
};

pub use actor::{Actor, interpolated};
pub use error::SimError;
pub use ghost::Ghost;
pub use physics_bridge::GroundKind;
pub use playback::Playback;
pub use setup::{MAX_CHARACTERS, SimConfig};
pub use totals::{StateHash, Totals};

/// Seconds a character without a skill to rise lies before it is stood up again.
pub const LIE_SECS: f32 = 2.0;
/// Length of a control tick, seconds.
pub const TICK_SECS: f32 = 1.0 / physics_bridge::CONTROL_HZ as f32;

/// What stands in for the pad: set by panels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Overrides {
    /// Where on the graph to go instead of where the triggers say.
    pub goal: Option<Goal>,
    /// Blend weights instead of the place on the graph.
    pub blend: Option<Blend>,
    /// How blends become actions.
    pub mode: BlendMode,
    /// A skill to start at the next tick.
    pub skill: Option<usize>,
}

/// Time that one tick took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TickTimes {
    /// Controllers of all characters, on all threads together.
    pub policy: Duration,
    /// The whole tick, on the clock.
    pub whole: Duration,
}

/// A character that blew up: what is known, and the state it came from.
#[derive(Debug)]
pub struct Blowup {
    /// Index of the character.
    pub character: usize,
    /// What the physics said.
    pub what: String,
    /// The state before, to be replayed.
    pub dump: Dump,
}

/// Shoves the characters, away from the camera.
pub const SHOVE_BUTTON: Button = Button::LeftShoulder;

/// Force of a shove on the torso, newton: more than any gait survives.
const SHOVE_NEWTON: f32 = 1200.0;

/// Length of a shove, seconds.
const SHOVE_SECS: f32 = 0.2;

/// A torso that is faster is not shoved, metres per second: above any gait.
const SHOVED_BELOW_MPS: f32 = 5.0;

/// Least factor on friction: ice. Contacts of less, down to none, make the physics diverge.
pub const LEAST_FRICTION: f32 = 0.01;

/// Characters, controllers and ground.
#[derive(Debug)]
pub struct Simulation {
    config: SimConfig,
    pack: Arc<CharacterPack>,
    model: Model,
    crowd: Crowd,
    actors: Vec<Actor>,
    ghost: Option<Ghost>,
    playback: Option<Playback>,
    mapper: CommandMapper,
    /// Buttons of the last tick, for the shove.
    shove_held: Buttons,
    /// Stands in for the pad.
    pub overrides: Overrides,
    ticks: u64,
    times: TickTimes,
    totals: Totals,
}

impl Simulation {
    /// Runs one control tick under `pad`, for a camera that looks along `camera`. Characters that blow up are
    /// back in their state before it, and are answered. While a clip is played it goes on by a tick instead.
    pub fn tick(&mut self, pad: &GamepadState, camera: Heading) -> Vec<Blowup> {
        if self.tick_playback() {
            return Vec::new();
        }
        let start = Instant::now();
        let command = self.command(pad, camera);
        let home = self.actors[0].position();
        self.shove(pad, camera);
        for actor in &mut self.actors {
            actor.receive(&command, home);
        }
        self.crowd.tick_with(&mut self.actors, |_, actor, state, targets| actor.steer(state, targets));
        let blowups = self.blowups();
        if let Some(ghost) = &mut self.ghost {
            ghost.tick(&command, home);
        }
        self.times =
            TickTimes { policy: self.actors.iter().map(|a| a.policy_time).sum(), whole: start.elapsed() };
        for (actor, character) in self.actors.iter_mut().zip(self.crowd.characters()) {
            actor.observe(character, &mut self.totals);
        }
        self.totals.times(self.times);
        for index in 0..self.actors.len() {
            if self.actors[index].lay_secs >= LIE_SECS {
                self.stand_up(index);
            }
        }
        self.ticks += 1;
        self.overrides.skill = None;
        blowups
    }

    /// The pad's command with what panels override.
    fn command(&mut self, pad: &GamepadState, camera: Heading) -> Command {
        let mut command = self.mapper.map(pad, camera, &self.actors[0].state);
        command.goal = self.overrides.goal.unwrap_or(command.goal);
        command.blend = self.overrides.blend;
        command.mode = self.overrides.mode;
        command.skill = self.overrides.skill.or(command.skill);
        command
    }

    /// A shove for every character, away from the camera, when the button goes down. One that is still being
    /// shoved, lies or already flies gets none: shoves must not add up.
    fn shove(&mut self, pad: &GamepadState, camera: Heading) {
        let pressed = pad.buttons.pressed_since(self.shove_held);
        self.shove_held = pad.buttons;
        if !pressed.contains(SHOVE_BUTTON) {
            return;
        }
        let force = (camera.direction() * SHOVE_NEWTON).extend(0.0);
        for (actor, character) in self.actors.iter_mut().zip(self.crowd.characters_mut()) {
            // The force is within the bounds of a push.
            if actor.can_be_shoved() && character.push(Body::Torso, force, SHOVE_SECS).is_ok() {
                actor.shoved_secs = SHOVE_SECS;
            }
        }
    }

    fn blowups(&self) -> Vec<Blowup> {
        let describe = |(character, diverged): (usize, &Diverged)| Blowup {
            character,
            what: diverged.to_string(),
            dump: (*diverged.dump).clone(),
        };
        self.crowd.diverged().map(describe).collect()
    }

    /// Stands a character up where it is.
    pub fn stand_up(&mut self, index: usize) {
        let (at, heading) = (self.actors[index].position(), self.actors[index].heading());
        let at = if at.is_finite() { at } else { self.config.start_of(index) };
        if self.crowd.character_mut(index).stand_at(at.x, at.y, heading, 0.0).is_ok() {
            self.totals.stood_up += 1;
            self.actors[index].restart(self.crowd.character(index));
        }
    }

    /// Everybody back to the start.
    pub fn reset(&mut self) {
        if self.playback.is_some() {
            return self.show_pose(0);
        }
        for index in 0..self.actors.len() {
            let (at, heading) = (self.config.start_of(index), self.config.heading_of(index));
            if self.crowd.character_mut(index).stand_at(at.x, at.y, heading, 0.0).is_ok() {
                self.actors[index].restart(self.crowd.character(index));
            }
        }
        self.mapper.reset();
        if let Some(ghost) = self.ghost.take() {
            self.start_ghost(ghost.mode());
        }
    }

    /// Changes gravity, friction and strength. Friction below [`LEAST_FRICTION`] is raised to it.
    ///
    /// # Errors
    /// When a setting is out of its range; nothing is changed then.
    pub fn set_settings(&mut self, settings: Settings) -> Result<(), SimError> {
        let settings = Settings { friction: settings.friction.max(LEAST_FRICTION), ..settings };
        let model = self.model.with_settings(settings)?;
        for character in self.crowd.characters_mut() {
            character.set_model(&model)?;
        }
        if let Some(ghost) = &mut self.ghost {
            ghost.character_mut().set_model(&model)?;
        }
        self.model = model;
        Ok(())
    }

    /// A second character from the player's present state, under another blend mode.
    pub fn start_ghost(&mut self, mode: BlendMode) {
        self.ghost = Ghost::of(self.crowd.character(0), &self.actors[0], mode);
    }

    /// Ends the comparison.
    pub fn stop_ghost(&mut self) {
        self.ghost = None;
    }

    /// Takes every character that keeps a history to its state `age` ticks ago; what came after is forgotten
    /// when the next tick runs.
    pub fn rewind_to(&mut self, age: usize) {
        for (actor, character) in self.actors.iter_mut().zip(self.crowd.characters_mut()) {
            if character.rewind_to(age).is_ok() {
                actor.rewind_to(age, character);
            }
        }
    }

    /// Puts the player's controller at a place on the graph at once.
    pub fn place_at(&mut self, position: GraphPosition) {
        self.actors[0].controller.place_at(position);
    }
}
