//! The demo in a browser: the playground of `lockstep`, drawn by the renderer of `viewer`, steered by the page.
//!
//! The page owns the clock, the devices and all text. What it hands in is a pad and a time; what it gets is a picture and
//! a state. Nothing in here reads a clock.

mod game;
mod stage;

use lockstep::{ArenaConfig, ArenaScene, LooseKind, PUT_BUTTON, SHOVE_BUTTON, THROW_BUTTON};
use policy_core::{Button, Buttons, GamepadState};
use viewer::render::Appearance;
use wasm_bindgen::prelude::*;

use crate::game::Game;
use crate::stage::{Screen, Stage};

/// Names of the buttons in the order of the bits that the page sends.
const BUTTONS: [Button; 8] = [
    Button::South,
    Button::East,
    Button::North,
    Button::West,
    SHOVE_BUTTON,
    Button::RightShoulder,
    THROW_BUTTON,
    PUT_BUTTON,
];

/// The demo of one page.
#[wasm_bindgen]
pub struct Demo {
    game: Game,
    stage: Stage,
}

/// A world and how its characters look: all that needs no screen, made while that is opened.
#[wasm_bindgen]
pub struct Ready {
    game: Game,
    appearance: Appearance,
}

#[wasm_bindgen]
impl Ready {
    /// The playground, or flat ground with crates. `pack` and `mesh` are the files that the page has fetched.
    ///
    /// # Errors
    /// When a file is no pack or mesh, or the world can't hold so many players.
    pub fn make(pack: Vec<u8>, mesh: &[u8], players: usize, flat: bool) -> Result<Ready, JsError> {
        let chosen = ArenaConfig { players, ..ArenaConfig::default() };
        let scene = if flat { chosen.scene } else { ArenaScene::Playground };
        let game = Game::new(pack, ArenaConfig { scene, ..chosen })?;
        let appearance = stage::appearance(&game, mesh)?;
        Ok(Self { game, appearance })
    }
}

#[wasm_bindgen]
impl Demo {
    /// The demo of a world on a screen.
    pub fn start(ready: Ready, screen: Screen) -> Demo {
        let Ready { game, appearance } = ready;
        let stage = Stage::new(screen, &game, appearance);
        Self { game, stage }
    }

    /// What draws.
    pub fn adapter(&self) -> String {
        self.stage.adapter().into()
    }

    /// True when the processor draws, as far as the browser tells.
    pub fn is_software(&self) -> bool {
        self.stage.is_software()
    }

    /// Why nothing can be drawn any more, once that is so.
    pub fn lost(&self) -> Option<String> {
        self.stage.lost().map(str::to_owned)
    }

    /// The canvas has this many pixels now.
    pub fn resize(&mut self, width: u32, height: u32) {
        self.stage.resize([width, height]);
    }

    /// Lets `secs` of the clock pass under a pad: left stick x and y, right stick x and y, left and right trigger, and one
    /// bit for each button. Returns the ticks that were run.
    ///
    /// # Errors
    /// When a replay stops because its state differs.
    pub fn advance(&mut self, secs: f32, pad: &[f32], buttons: u32) -> Result<u32, JsError> {
        let value = |index: usize| pad.get(index).copied().filter(|v| v.is_finite()).unwrap_or(0.0);
        let mut held = Buttons::NONE;
        for (bit, button) in BUTTONS.into_iter().enumerate() {
            held.set(button, buttons & (1 << bit) != 0);
        }
        let state = GamepadState {
            left_stick: [value(0), value(1)],
            right_stick: [value(2), value(3)],
            left_trigger: value(4),
            right_trigger: value(5),
            buttons: held,
        };
        let ticks = self.game.advance(secs, &state, self.stage.heading())?;
        self.stage.follow(secs, state.right_stick, &self.game);
        Ok(ticks)
    }

    /// Draws the world as it is. False when the canvas gives no picture just now.
    pub fn draw(&mut self) -> bool {
        self.stage.draw(&self.game)
    }

    /// Draws coarser shadows and meshes from now on, for a machine that is slow; or fine ones again.
    pub fn draw_cheaply(&mut self, on: bool) {
        self.stage.draw_cheaply(on);
    }

    /// Turns the camera, radians; for a mouse or a finger.
    pub fn turn(&mut self, x: f32, y: f32) {
        self.stage.turn(x, y);
    }

    /// Brings the camera closer, below 1, or takes it away.
    pub fn zoom(&mut self, factor: f32) {
        self.stage.zoom(factor);
    }

    /// Control ticks so far.
    pub fn ticks(&self) -> u32 {
        self.game.ticks()
    }

    /// Length of a control tick, seconds.
    pub fn tick_secs(&self) -> f32 {
        self.game.tick_secs()
    }

    /// Hash of the state, sixteen hexadecimal digits.
    pub fn hash(&mut self) -> String {
        format!("{:016x}", self.game.hash())
    }

    /// What the player's character does, in a few words.
    pub fn doing(&self) -> String {
        self.game.doing()
    }

    /// Clock and falls of the course, in a few words.
    pub fn course(&self) -> String {
        self.game.course()
    }

    /// Seconds and falls of a run over the course that is done; empty before.
    pub fn finished(&self) -> Vec<f32> {
        self.game.finished().map_or(Vec::new(), |(secs, falls)| vec![secs, falls as f32])
    }

    /// How many more balls can be thrown, or else things be put down.
    pub fn left(&self, balls: bool) -> usize {
        let arena = self.game.arena();
        if balls {
            arena.left(LooseKind::Ball)
        } else {
            LooseKind::PUT.into_iter().map(|kind| arena.left(kind)).sum()
        }
    }

    /// Seconds that the replay still takes; undefined when none is played.
    pub fn replay_left(&self) -> Option<f32> {
        self.game.replay_left()
    }

    /// Names of the policies.
    pub fn policies(&self) -> Vec<String> {
        self.game.pack().graph().nodes().iter().map(|node| node.name.replace('_', " ")).collect()
    }

    /// Weight of each of them in what the player's character does.
    pub fn weights(&self) -> Vec<f32> {
        self.game.weights()
    }

    /// Begins anew, under the fixed input of 20 s when `script` is true.
    ///
    /// # Errors
    /// When the world can't be made.
    pub fn restart(&mut self, script: bool) -> Result<(), JsError> {
        self.game.restart(script)?;
        self.stage.reset(&self.game);
        Ok(())
    }

    /// What was played since the start, as text for a link.
    ///
    /// # Errors
    /// When it is too long for one.
    pub fn link(&self) -> Result<String, JsError> {
        Ok(self.game.replay().to_link()?)
    }

    /// What was played since the start, as a file.
    pub fn replay_file(&self) -> Vec<u8> {
        self.game.replay().to_bytes()
    }

    /// Plays what [`Demo::link`] wrote, from the start.
    ///
    /// # Errors
    /// When the text is no replay of this world.
    pub fn play_link(&mut self, link: &str) -> Result<(), JsError> {
        let replay = replay::Replay::from_link(link)?;
        self.play(&replay)
    }

    /// Plays a replay file from the start.
    ///
    /// # Errors
    /// When the bytes are no replay of this world.
    pub fn play_file(&mut self, bytes: &[u8]) -> Result<(), JsError> {
        let replay = replay::Replay::from_bytes(bytes)?;
        self.play(&replay)
    }

    /// `playing`, `script`, `recording` or `over`.
    pub fn mode(&self) -> String {
        self.game.mode().into()
    }
}

impl Demo {
    fn play(&mut self, replay: &replay::Replay) -> Result<(), JsError> {
        self.game.play(replay)?;
        self.stage.reset(&self.game);
        Ok(())
    }
}
