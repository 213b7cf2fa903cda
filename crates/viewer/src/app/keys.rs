//! The keyboard as a pad, and the keys of the demo itself.

use egui::{Key, Ui};
use policy_core::{BlendMode, Button, Buttons, GamepadState};

use super::latch::Latch;
use super::{App, KeyAction, KeyMap, Record, ViewerCommand};
use crate::camera::CameraMode;
use crate::sim::{GhostKind, SHOVE_BUTTON};

/// Seconds in which a held key runs a trigger from 0 to 1, and back when it is released.
const RAMP_SECS: f32 = 1.2;
/// Seconds in which the stick follows the keys.
const STICK_SECS: f32 = 0.15;

/// Buttons that keys press.
const BUTTON_KEYS: [(KeyAction, Button); 7] = [
    (KeyAction::GetUp, Button::South),
    (KeyAction::Roll, Button::East),
    (KeyAction::Jump, Button::North),
    (KeyAction::Punch, Button::West),
    (KeyAction::Style, Button::RightShoulder),
    (KeyAction::Strafe, Button::RightStick),
    (KeyAction::Shove, SHOVE_BUTTON),
];

/// Keys held, and the sticks and triggers that they make.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Keys {
    wanted_stick: [f32; 2],
    wanted_right: [f32; 2],
    wanted_triggers: [f32; 2],
    buttons: Buttons,
    /// Buttons whose keys went down since the last tick.
    tapped: Latch,
    stick: [f32; 2],
    triggers: [f32; 2],
    flight: [f32; 3],
}

/// Keys that turn and fly the camera, throw balls and put props down.
const PICTURE_KEYS: [Key; 12] = [
    Key::I,
    Key::O,
    Key::U,
    Key::L,
    Key::ArrowUp,
    Key::ArrowDown,
    Key::ArrowLeft,
    Key::ArrowRight,
    Key::PageUp,
    Key::PageDown,
    Key::T,
    Key::Y,
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
            buttons: self.tapped.state(self.buttons),
        }
    }

    /// A tick has seen the keys.
    pub(super) fn end_tick(&mut self) {
        self.tapped.clear();
    }

    /// All keys up: another thing reads the keyboard. Sticks and triggers go back as if they were released.
    fn release(&mut self) {
        *self = Self { stick: self.stick, triggers: self.triggers, ..Self::default() };
    }

    /// Where a free camera is to fly: ahead, to the right and up, each in [-1, 1].
    #[must_use]
    pub fn flight(&self) -> [f32; 3] {
        self.flight
    }

    /// Takes the keys that are held. The arrow keys walk, or fly a free camera.
    fn hold(&mut self, input: &egui::InputState, map: &KeyMap, flies: bool) {
        let down = |keys: &[Key]| f32::from(u8::from(keys.iter().any(|&key| input.key_down(key))));
        let axis = |plus: &[Key], minus: &[Key]| down(plus) - down(minus);
        let key = |action| map.key(action);
        let arrows = [axis(&[Key::ArrowRight], &[Key::ArrowLeft]), axis(&[Key::ArrowUp], &[Key::ArrowDown])];
        let mut stick = [
            axis(&[key(KeyAction::Right)], &[key(KeyAction::Left)]),
            axis(&[key(KeyAction::Ahead)], &[key(KeyAction::Back)]),
        ];
        self.flight = [0.0; 3];
        if flies {
            self.flight = [arrows[1], arrows[0], axis(&[Key::PageUp], &[Key::PageDown])];
        } else {
            stick = [stick[0] + arrows[0], stick[1] + arrows[1]];
        }
        let length = stick[0].hypot(stick[1]).max(1.0);
        let push = if input.modifiers.shift { 0.5 } else { 1.0 };
        self.wanted_stick = stick.map(|v| v / length * push);
        self.wanted_right = [axis(&[Key::L], &[Key::U]), axis(&[Key::O], &[Key::I])].map(|v| 0.6 * v);
        self.wanted_triggers = [down(&[key(KeyAction::Lower)]), down(&[key(KeyAction::Faster)])];
        let mut buttons = Buttons::NONE;
        for (action, button) in BUTTON_KEYS {
            if goes_down(input, key(action), false) {
                self.tapped.press(button);
            }
            buttons.set(button, input.key_down(key(action)));
        }
        self.buttons = buttons;
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
        app.keys.release();
        return;
    }
    if let Some(action) = app.rebinding {
        app.keys.release();
        return rebind(ui, app, action, commands);
    }
    ui.input(|input| {
        app.keys.hold(input, &app.layout.preferences.keys, app.camera.mode == CameraMode::Free);
        for (key, command) in shortcuts(app) {
            // A text field or drop-down that was open takes this key for itself.
            let taken = key == Key::Escape && app.escape_taken;
            if goes_down(input, key, REPEATING_KEYS.contains(&key)) && !taken {
                commands.push(command);
            }
        }
        if app.leaving && goes_down(input, Key::Enter, false) {
            commands.push(ViewerCommand::Quit);
        }
    });
}

/// Shortcuts that act again and again while their key is held: ticks and speeds.
const REPEATING_KEYS: [Key; 5] = [Key::N, Key::B, Key::Minus, Key::Plus, Key::Equals];

/// True when a key went down in this frame; with `repeats` also when it is held for so long that it repeats.
pub(super) fn goes_down(input: &egui::InputState, key: Key, repeats: bool) -> bool {
    input.events.iter().any(|event| match event {
        egui::Event::Key { key: pressed, pressed: true, repeat, .. } => {
            *pressed == key && (repeats || !repeat)
        }
        _ => false,
    })
}

/// Gives the key that is pressed to an action. Escape gives up; a key of the demo itself is refused.
fn rebind(ui: &Ui, app: &App, action: KeyAction, commands: &mut Vec<ViewerCommand>) {
    let pressed = ui.input(|input| {
        input.events.iter().find_map(|event| match event {
            egui::Event::Key { key, pressed: true, repeat: false, .. } => Some(*key),
            _ => None,
        })
    });
    let Some(key) = pressed else { return };
    if key != Key::Escape {
        if shortcuts(app).iter().any(|(taken, _)| *taken == key) || PICTURE_KEYS.contains(&key) {
            commands.push(ViewerCommand::Complain(format!("{} is already used.", key.name())));
        } else {
            let mut preferences = app.layout.preferences;
            preferences.keys.bind(action, key);
            commands.push(ViewerCommand::Preferences(preferences));
        }
    }
    commands.push(ViewerCommand::Rebind(None));
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
        (Key::Home, ViewerCommand::ResetCamera),
        (Key::F4, ViewerCommand::ChoosePreferences(!app.choosing)),
        (Key::C, ViewerCommand::Camera(next(&CameraMode::ALL, app.camera.mode))),
        (Key::M, ViewerCommand::Mode(next_mode)),
        (Key::G, ViewerCommand::Ghost(ghost)),
        (Key::X, ViewerCommand::Shown(shown)),
    ]
}

/// Closes what is open; where nothing is, asks before leaving.
fn escape(app: &App) -> ViewerCommand {
    match (app.help, app.choosing, app.leaving) {
        (true, ..) => ViewerCommand::Help(false),
        (_, true, _) => ViewerCommand::ChoosePreferences(false),
        (.., leaving) => ViewerCommand::AskToQuit(!leaving),
    }
}

/// The one after `current`, round and round.
fn next<T: Copy + PartialEq>(all: &[T], current: T) -> T {
    let index = all.iter().position(|&x| x == current).unwrap_or(0);
    all[(index + 1) % all.len()]
}
