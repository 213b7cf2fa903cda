//! The world of the demo: characters in the physics, each with its controller. The window and runs without one use
//! the same code. Knows nothing of drawing, devices or panels.

mod error;
mod ghost;
mod playback;
mod queries;
mod rewind;
mod setup;
mod steered;
mod totals;

use std::sync::Arc;
use std::time::{Duration, Instant};

use physics_bridge::{Crowd, Diverged, Model, ReplayFile, Settings};
use policy_core::{
    Blend, BlendMode, BodyId, Button, CharacterPack, Command, CommandMapper, GamepadState, Goal,
    GraphPosition, Heading, SkillId,
};

pub use error::SimError;
pub use ghost::Ghost;
pub use physics_bridge::GroundKind;
pub use playback::Playback;
use rewind::PadRing;
pub use setup::{MAX_CHARACTERS, SimConfig, model_of, rest_positions};
pub use steered::{SteeredCharacter, interpolated};
pub use totals::Totals;

/// Seconds after which a character without a skill to get up is stood up.
pub const LIE_SECS: f32 = 2.0;

/// What stands in for the pad: set by panels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Overrides {
    /// Where on the graph to go instead of where the triggers say.
    pub goal: Option<Goal>,
    /// Blend weights instead of the place on the graph.
    pub blend: Option<Blend>,
    /// A skill to start at the next tick.
    pub skill: Option<SkillId>,
}

/// Time that one tick took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TickTimes {
    /// Controllers of all characters, on all threads together.
    pub policy: Duration,
    /// The whole tick, on the clock.
    pub whole: Duration,
}

/// A character whose physics diverged: what is known, and the state it came from.
#[derive(Debug)]
pub struct Divergence {
    /// Index of the character.
    pub character: usize,
    /// What the physics said.
    pub what: String,
    /// The state before, to be replayed.
    pub replay: ReplayFile,
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

/// How the characters of a skeleton are shoved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shove {
    /// The body that is pushed: the one that the head hangs on, else the root.
    pub(super) body: BodyId,
    /// A root that is lower belongs to a character that lies, metres above the ground.
    pub(super) least_height: f32,
}

/// Characters, controllers and ground.
#[derive(Debug)]
pub struct Simulation {
    config: SimConfig,
    pack: Arc<CharacterPack>,
    model: Model,
    crowd: Crowd,
    steered: Vec<SteeredCharacter>,
    ghost: Option<Ghost>,
    playback: Option<Playback>,
    mapper: CommandMapper,
    /// The pad of the last tick: buttons act when they go down.
    last_pad: GamepadState,
    pads: PadRing,
    shove: Shove,
    /// Stands in for the pad.
    pub overrides: Overrides,
    /// Before every tick puts a new controller in the place of each, its state carried over as bytes. Changes no bit;
    /// slow, for checks.
    pub renews_controllers: bool,
    ticks: u64,
    times: TickTimes,
    totals: Totals,
}

impl Simulation {
    /// Runs one control tick under `pad`, for a camera that looks along `camera`. Characters whose physics diverge are
    /// back in their state before it, and are returned. While a clip is played, the clip advances by a tick instead.
    pub fn tick(&mut self, pad: &GamepadState, camera: Heading) -> Vec<Divergence> {
        if self.tick_playback() {
            return Vec::new();
        }
        let start = Instant::now();
        if self.renews_controllers {
            self.renew_controllers();
        }
        let dt_secs = self.tick_secs();
        let command = self.command(pad, camera);
        let home = self.steered[0].position();
        self.shove(pad, camera);
        for steered in &mut self.steered {
            steered.receive(&command, home);
        }
        self.crowd.control_tick_with(&mut self.steered, dt_secs, |_, steered| {
            (&mut steered.controller, steered.command)
        });
        if let Some(ghost) = &mut self.ghost {
            ghost.tick(&command, home, dt_secs);
        }
        self.times = TickTimes { policy: self.crowd.control_time(), whole: start.elapsed() };
        let divergences = self.observe(dt_secs);
        self.totals.times(self.times);
        self.last_pad = *pad;
        if divergences.iter().all(|d| d.character != 0) {
            *self.pads.next() = *pad;
        }
        for index in 0..self.steered.len() {
            if self.steered[index].down_secs >= LIE_SECS {
                self.stand_up(index);
            }
        }
        self.ticks += 1;
        self.overrides.skill = None;
        divergences
    }

    /// The pad's command with what panels override.
    fn command(&mut self, pad: &GamepadState, camera: Heading) -> Command {
        let mut command = self.mapper.map(pad, camera, &self.steered[0].state);
        command.goal = self.overrides.goal.unwrap_or(command.goal);
        command.blend = self.overrides.blend;
        command.skill = self.overrides.skill.or(command.skill);
        command
    }

    /// A shove for every character, away from the camera, when the button goes down. One that is still being shoved,
    /// lies or already flies gets none: shoves must not add up.
    fn shove(&mut self, pad: &GamepadState, camera: Heading) {
        if !pad.buttons.pressed_since(self.last_pad.buttons).contains(SHOVE_BUTTON) {
            return;
        }
        let force = (camera.direction() * SHOVE_NEWTON).extend(0.0);
        let Shove { body, least_height } = self.shove;
        for (steered, character) in self.steered.iter_mut().zip(self.crowd.characters_mut()) {
            // The force is within the bounds of a push.
            if steered.can_be_shoved(least_height) && character.push(body, force, SHOVE_SECS).is_ok() {
                steered.shoved_secs = SHOVE_SECS;
            }
        }
    }

    /// Updates every character from its physics.
    fn observe(&mut self, dt_secs: f32) -> Vec<Divergence> {
        let describe = |(character, diverged): (usize, &Diverged)| Divergence {
            character,
            what: diverged.to_string(),
            replay: (*diverged.replay).clone(),
        };
        let divergences: Vec<Divergence> = self.crowd.diverged().map(describe).collect();
        for (index, steered) in self.steered.iter_mut().enumerate() {
            let character = self.crowd.character(index);
            if divergences.iter().any(|d| d.character == index) {
                steered.observe_divergence(character);
            } else {
                steered.observe(character, dt_secs, &mut self.totals);
            }
        }
        divergences
    }

    /// Stands a character up where it is.
    pub fn stand_up(&mut self, index: usize) {
        let (at, heading) = (self.steered[index].position(), self.steered[index].heading());
        let at = if at.is_finite() { at } else { self.config.start_of(index) };
        if self.crowd.character_mut(index).stand_at(at.x, at.y, heading, 0.0).is_ok() {
            self.totals.stood_up += 1;
            self.restart(index);
        }
    }

    /// Puts every character back to the start.
    pub fn reset(&mut self) {
        if self.playback.is_some() {
            return self.show_pose(0);
        }
        for index in 0..self.steered.len() {
            let (at, heading) = (self.config.start_of(index), self.config.heading_of(index));
            if self.crowd.character_mut(index).stand_at(at.x, at.y, heading, 0.0).is_ok() {
                self.restart(index);
            }
        }
        self.mapper.reset();
        self.last_pad = GamepadState::default();
        self.restart_ghost();
    }

    /// Begins anew with a character that was put somewhere. The player's history begins with its pad.
    fn restart(&mut self, index: usize) {
        self.steered[index].restart(self.crowd.character(index));
        if index == 0 {
            self.pads.clear();
            *self.pads.next() = self.last_pad;
        }
    }

    /// Changes gravity, friction, strength and mass. Friction below [`LEAST_FRICTION`] is raised to it.
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

    /// How every controller makes an action of a blend, from the next tick on. The ghost keeps its own mode.
    pub fn set_blend_mode(&mut self, mode: BlendMode) {
        self.steered.iter_mut().for_each(|steered| steered.controller.set_blend_mode(mode));
    }

    /// A second character from the player's present state, under another blend mode.
    pub fn start_ghost(&mut self, mode: BlendMode) {
        self.ghost = Ghost::of(self.crowd.character(0), &self.steered[0], mode);
    }

    /// Ends the comparison.
    pub fn stop_ghost(&mut self) {
        self.ghost = None;
    }

    /// Starts the ghost again from the player's present state, if there is one.
    fn restart_ghost(&mut self) {
        if let Some(ghost) = self.ghost.take() {
            self.start_ghost(ghost.mode());
        }
    }

    /// Takes every character that keeps a history to its state `age` ticks ago, with its controller. The next tick
    /// continues from there as it did the first time, bit for bit under the same pad; what came after is forgotten.
    pub fn rewind_to(&mut self, age: usize) {
        for (steered, character) in self.steered.iter_mut().zip(self.crowd.characters_mut()) {
            if character.rewind_to(age).is_ok() {
                steered.rewind_to(age, character);
            }
        }
        if let Some(pad) = self.pads.rewind_to(age).copied() {
            self.last_pad = pad;
            // The mapper remembers the buttons of the pad that it saw last.
            self.mapper.map(&pad, Heading::FORWARD, &self.steered[0].state);
        }
        self.restart_ghost();
    }

    fn renew_controllers(&mut self) {
        for steered in &mut self.steered {
            steered.renew_controller().expect("the state comes from a controller of the same pack");
        }
    }

    /// Puts the player's controller at a position on the graph at once. Returns false when the graph has no such
    /// position.
    pub fn place_at(&mut self, position: GraphPosition) -> bool {
        self.steered[0].controller.place_at(position)
    }
}
