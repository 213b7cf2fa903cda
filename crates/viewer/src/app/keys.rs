//! The keyboard as a pad, and the keys of the demo itself.

use egui::{Key, Ui};
use policy_core::{BlendMode, Button, Buttons, GamepadState};

use super::{App, Record, ViewerCommand};
use crate::camera::CameraMode;
use crate::sim::{GhostKind, SHOVE_BUTTON};

/// Seconds in which a held key runs a trigger from 0 to 1, and back when it is released.
const RAMP_SECS: f32 = 1.2;
/// Seconds in which the stick follows the keys.
const STICK_SECS: f32 = 0.15;

/// Keys held, and the sticks and triggers that they make.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Keys {
    wanted_stick: [f32; 2],
    wanted_right: [f32; 2],
    wanted_triggers: [f32; 2],
    buttons: Buttons,
    stick: [f32; 2],
    triggers: [f32; 2],
}

/// What keys do, for the help overlay.
pub const KEYS: [(&str, &str); 20] = [
    ("W A S D, arrows", "walk where the camera looks; with Shift half as fast"),
    ("E", "hold: right trigger, the speed path; it returns slowly"),
    ("Q", "hold: left trigger, the stance path"),
    ("Z", "hold: right shoulder, the style path, where the pack has one"),
    ("Space", "get up"),
    ("R", "roll"),
    ("J, K", "jump, kick, where the pack has them"),
    ("V", "shove the character to the ground"),
    ("right mouse, I O U L", "turn the camera; wheel: closer or away"),
    ("left mouse on a body", "pull it; in the playground also a prop"),
    ("T, Y", "in the playground: throw a ball at the mouse, put a prop there"),
    ("C", "camera: orbit, follow, fixed"),
    ("P, N, B", "pause, one tick, one tick back"),
    ("minus, plus", "slower, faster"),
    ("Backspace", "back to the start"),
    ("M", "blend mode: parameters, actions, switch"),
    ("G", "ghost under another mode"),
    ("X", "collision shapes"),
    ("F2, F3", "screenshot, film"),
    ("Tab, F1, Esc", "hide panels, this help, leave (it asks first)"),
];

/// What pad controls do, for the help overlay.
pub const PAD: [(&str, &str); 10] = [
    ("left stick", "direction and speed"),
    ("right stick", "camera"),
    ("right trigger", "speed path: walk, jog, run"),
    ("left trigger", "stance path: walk, crouch, crawl"),
    ("A or cross", "get up"),
    ("B or circle", "roll"),
    ("Y or triangle, X or square", "jump, kick, where the pack has them"),
    ("right shoulder", "hold: style path, where the pack has one"),
    ("left shoulder", "shove the character to the ground"),
    ("d-pad up, down", "in the playground: throw a ball, put a prop down"),
];

impl Keys {
    /// The pad that the keys are.
    #[must_use]
    pub fn state(&self) -> GamepadState {
        GamepadState {
            left_stick: self.stick,
            right_stick: self.wanted_right,
            left_trigger: self.triggers[0],
            right_trigger: self.triggers[1],
            buttons: self.buttons,
        }
    }

    /// Sticks and triggers follow the keys for `dt` seconds.
    pub fn advance(&mut self, dt: f32) {
        let towards = |value: &mut f32, wanted: f32, seconds: f32| {
            let step = dt / seconds;
            *value += (wanted - *value).clamp(-step, step);
        };
        for i in 0..2 {
            towards(&mut self.stick[i], self.wanted_stick[i], STICK_SECS);
            towards(&mut self.triggers[i], self.wanted_triggers[i], RAMP_SECS);
        }
    }
}

/// Gives the keyboard back to the game: only a text field keeps it. Without this, Tab would move egui's focus from
/// button to button, and every key would go there.
pub(super) fn release(context: &egui::Context, app: &mut App) {
    app.escape_taken = context.text_edit_focused() || egui::Popup::is_any_open(context);
    if let Some(focused) = context.memory(egui::Memory::focused)
        && !context.text_edit_focused()
    {
        context.memory_mut(|memory| memory.surrender_focus(focused));
    }
}

/// Reads the keys of this frame.
pub(super) fn read(ui: &Ui, app: &mut App, commands: &mut Vec<ViewerCommand>) {
    if ui.ctx().text_edit_focused() {
        app.keys = Keys { stick: app.keys.stick, triggers: app.keys.triggers, ..Keys::default() };
        return;
    }
    ui.input(|input| {
        let axis = |plus: &[Key], minus: &[Key]| {
            let down = |keys: &[Key]| f32::from(u8::from(keys.iter().any(|&k| input.key_down(k))));
            down(plus) - down(minus)
        };
        let mut stick = [
            axis(&[Key::D, Key::ArrowRight], &[Key::A, Key::ArrowLeft]),
            axis(&[Key::W, Key::ArrowUp], &[Key::S, Key::ArrowDown]),
        ];
        let length = stick[0].hypot(stick[1]).max(1.0);
        let push = if input.modifiers.shift { 0.5 } else { 1.0 };
        stick = stick.map(|v| v / length * push);
        app.keys.wanted_stick = stick;
        app.keys.wanted_right = [axis(&[Key::L], &[Key::U]), axis(&[Key::O], &[Key::I])].map(|v| 0.6 * v);
        app.keys.wanted_triggers = [axis(&[Key::Q], &[]), axis(&[Key::E], &[])];
        let mut buttons = Buttons::NONE;
        let held = [
            (Key::Space, Button::South),
            (Key::R, Button::East),
            (Key::J, Button::North),
            (Key::K, Button::West),
            (Key::Z, Button::RightShoulder),
            (Key::V, SHOVE_BUTTON),
        ];
        for (key, button) in held {
            buttons.set(button, input.key_down(key));
        }
        app.keys.buttons = buttons;
        for (key, command) in shortcuts(app) {
            // A text field or drop-down that was open takes this key for itself.
            let taken = key == Key::Escape && app.escape_taken;
            if input.key_pressed(key) && !taken {
                commands.push(command);
            }
        }
        if app.leaving && input.key_pressed(Key::Enter) {
            commands.push(ViewerCommand::Quit);
        }
    });
}

/// Keys that act once.
fn shortcuts(app: &App) -> Vec<(Key, ViewerCommand)> {
    let mut shown = app.layout.shown;
    shown.collision_shapes = !shown.collision_shapes;
    let next_mode = next(&BlendMode::ALL, app.sim.blend_mode());
    let ghost = match app.sim.ghost() {
        Some(_) => None,
        None => Some(GhostKind::Mode(next_mode)),
    };
    let film = if app.recording.is_some() { Record::Stop } else { Record::Video };
    vec![
        (Key::F1, ViewerCommand::Help(!app.help)),
        (Key::F2, ViewerCommand::Record(Record::Screenshot)),
        (Key::F3, ViewerCommand::Record(film)),
        (Key::Tab, ViewerCommand::HidePanels(!app.layout.hidden)),
        (Key::Escape, escape(app)),
        (Key::P, ViewerCommand::Pause(!app.clock.paused)),
        (Key::N, ViewerCommand::Step),
        (Key::B, ViewerCommand::StepBack),
        (Key::Minus, ViewerCommand::Speed(app.clock.speed * 0.5)),
        (Key::Plus, ViewerCommand::Speed(app.clock.speed * 2.0)),
        (Key::Equals, ViewerCommand::Speed(app.clock.speed * 2.0)),
        (Key::Backspace, ViewerCommand::Reset),
        (Key::C, ViewerCommand::Camera(next(&CameraMode::ALL, app.camera.mode))),
        (Key::M, ViewerCommand::Mode(next_mode)),
        (Key::G, ViewerCommand::Ghost(ghost)),
        (Key::X, ViewerCommand::Shown(shown)),
    ]
}

/// Closes what is open; where nothing is, asks before leaving.
fn escape(app: &App) -> ViewerCommand {
    match (app.help, app.leaving) {
        (true, _) => ViewerCommand::Help(false),
        (_, leaving) => ViewerCommand::AskToQuit(!leaving),
    }
}

/// The one after `current`, round and round.
fn next<T: Copy + PartialEq>(all: &[T], current: T) -> T {
    let index = all.iter().position(|&x| x == current).unwrap_or(0);
    all[(index + 1) % all.len()]
}
