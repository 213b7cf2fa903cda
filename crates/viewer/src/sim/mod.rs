//! The world of the demo: characters in the physics, each with its controller. The window and runs without one use
//! the same code. Knows nothing of drawing, devices or panels.

mod bodies;
mod changes;
mod error;
mod ghost;
mod playback;
mod queries;
mod rewind;
mod scene_kind;
mod second;
mod setup;
mod shared;
mod steered;
mod throw;
mod totals;

use std::sync::Arc;
use std::time::{Duration, Instant};

use physics::{Diverged, Model};
use physics_bridge::ReplayFile;
use playground::WanderPath;
use policy_core::{
    Blend, BodyId, Button, CharacterPack, Command, CommandMapper, GamepadState, Goal, Heading, SkillId,
};

use bodies::Bodies;
pub use bodies::GroundContact;
pub use error::SimError;
pub use ghost::{Ghost, GhostKind};
pub use physics::Engine;
pub use physics_bridge::GroundKind;
pub use playback::Playback;
use rewind::PadRing;
pub use scene_kind::SceneKind;
pub use second::SECOND_CHARACTER;
use second::SecondPlayer;
pub use setup::{MAX_CHARACTERS, SimConfig, model_of, rest_positions};
pub use shared::{Held, LooseKind, MOST_BALLS, Piece, SharedWorld};
pub use steered::{SteeredCharacter, interpolated};
pub use throw::{SPAWN_BUTTON, THROW_BUTTON};
pub use totals::Totals;

/// Seconds after which a character without a skill to get up is stood up.
pub const LIE_SECS: f32 = 2.0;

/// What stands in for the pad: set by panels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Overrides {
    /// Where on the graph to go instead of where the triggers say.
    pub goal: Option<Goal>,
    /// Blend weights instead of the position on the graph.
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
    /// The state before, to be replayed, where the engine keeps it.
    pub replay: Option<ReplayFile>,
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
pub const LEAST_FRICTION: f32 = 0.05;

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
    bodies: Bodies,
    wander_path: WanderPath,
    steered: Vec<SteeredCharacter>,
    ghost: Option<Ghost>,
    playback: Option<Playback>,
    mapper: CommandMapper,
    /// The pad of the last tick: buttons act when they go down.
    last_pad: GamepadState,
    second: Option<SecondPlayer>,
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
        let last_pad = self.last_pad;
        self.throw(0, [&last_pad, pad], camera);
        let second = self.tick_second(camera);
        let divergences = self.step(&command, second.as_ref(), dt_secs);
        if let Some(ghost) = &mut self.ghost {
            ghost.tick(&command, home, dt_secs);
        }
        self.times.whole = start.elapsed();
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
        for (index, steered) in self.steered.iter_mut().enumerate() {
            // The force is within the bounds of a push.
            if steered.can_be_shoved(least_height) && self.bodies.push(index, body, force, SHOVE_SECS) {
                steered.shoved_secs = SHOVE_SECS;
            }
        }
    }

    /// Controllers and physics of all characters.
    fn step(&mut self, command: &Command, second: Option<&Command>, dt_secs: f32) -> Vec<Divergence> {
        let home = self.steered[0].position();
        match &mut self.bodies {
            Bodies::Apart(crowd) => {
                for steered in &mut self.steered {
                    steered.receive(command, home);
                }
                crowd.control_tick_with(&mut self.steered, dt_secs, |_, steered| {
                    (&mut steered.controller, steered.command)
                });
                self.times.policy = crowd.control_time();
                self.observe(dt_secs)
            }
            Bodies::Together(shared) => {
                shared.give_commands([Some(command), second], self.wander_path, &mut self.steered, dt_secs);
                let put_back = shared.tick(&mut self.steered, self.model.described(), dt_secs);
                self.times.policy = shared.control_time();
                self.observe_together(&put_back, dt_secs);
                Vec::new()
            }
        }
    }

    /// Updates every character of a shared world, which has put back what diverged.
    fn observe_together(&mut self, put_back: &[usize], dt_secs: f32) {
        for (index, steered) in self.steered.iter_mut().enumerate() {
            let body = self.bodies.of(index);
            if put_back.contains(&index) {
                steered.put_back(body);
                self.totals.stood_up += 1;
            } else {
                steered.observe(body, dt_secs, &mut self.totals);
            }
        }
        if let Bodies::Together(shared) = &mut self.bodies {
            shared.observe(&self.steered[0]);
        }
    }

    /// Updates every character that lives alone from its physics.
    fn observe(&mut self, dt_secs: f32) -> Vec<Divergence> {
        let describe = |(character, diverged): (usize, &Diverged)| Divergence {
            character,
            what: diverged.to_string(),
            replay: diverged.replay().cloned(),
        };
        let Bodies::Apart(crowd) = &self.bodies else { return Vec::new() };
        let divergences: Vec<Divergence> = crowd.diverged().map(describe).collect();
        for (index, steered) in self.steered.iter_mut().enumerate() {
            let body = self.bodies.of(index);
            if divergences.iter().any(|d| d.character == index) {
                steered.observe_divergence(body);
            } else {
                steered.observe(body, dt_secs, &mut self.totals);
            }
        }
        divergences
    }
}
