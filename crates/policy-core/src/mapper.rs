//! From a gamepad to a command: the left stick sets the target, the triggers run along two paths, buttons
//! ask for skills (paper, section 3.6).

use alloc::string::String;
use alloc::vec::Vec;

use glam::Vec2;

use crate::body::Body;
use crate::command::{Command, Goal};
use crate::gamepad_state::{Button, GamepadState};
use crate::heading::Heading;
use crate::observation::TARGET_RANGE_METRES;
use crate::pack::CharacterPack;
use crate::state::CharacterState;

/// Which control does what, by names of the pack. Names the pack lacks do nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct Bindings {
    /// Path of the right trigger. Its first node is for a stick at rest, its second for a full stick.
    pub speed_path: String,
    /// Path of the left trigger.
    pub stance_path: String,
    /// Path of a style of walking, whose last node is walked as while a button is held.
    pub style_path: String,
    /// That button.
    pub style_button: Button,
    /// Buttons and the skills they start.
    pub skills: Vec<(Button, String)>,
}

impl Default for Bindings {
    /// Right trigger `speed`, left trigger `stance`, right shoulder `style`; south `get_up`, east `roll`, north `jump`, west
    /// `kick`.
    fn default() -> Self {
        let skills = [
            (Button::South, "get_up"),
            (Button::East, "roll"),
            (Button::North, "jump"),
            (Button::West, "kick"),
        ];
        Self {
            speed_path: "speed".into(),
            stance_path: "stance".into(),
            style_path: "style".into(),
            style_button: Button::RightShoulder,
            skills: skills.into_iter().map(|(b, name)| (b, name.into())).collect(),
        }
    }
}

/// Maps gamepads to commands. Remembers which buttons were held, so it is one for each player.
#[derive(Clone, Debug)]
pub struct CommandMapper {
    speed: Option<(usize, f32)>,
    stance: Option<(usize, f32)>,
    style: Option<(usize, f32)>,
    style_button: Button,
    skills: Vec<(Button, usize)>,
    last: GamepadState,
}

/// A trigger below this does not choose its path.
const TRIGGER_THRESHOLD: f32 = 0.02;

/// A stick below this asks for no direction.
const STICK_THRESHOLD: f32 = 0.05;

impl CommandMapper {
    /// A mapper for the paths and skills of `pack`.
    #[must_use]
    pub fn new(pack: &CharacterPack, bindings: &Bindings) -> Self {
        let path = |name: &str| {
            let index = pack.graph().path_named(name)?;
            Some((index, pack.graph().paths()[index].end()))
        };
        let skill = |(button, name): &(Button, String)| Some((*button, pack.skill_named(name)?));
        Self {
            speed: path(&bindings.speed_path),
            stance: path(&bindings.stance_path),
            style: path(&bindings.style_path),
            style_button: bindings.style_button,
            skills: bindings.skills.iter().filter_map(skill).collect(),
            last: GamepadState::default(),
        }
    }

    /// The command of a pad, for a camera that looks along `camera`.
    ///
    /// Stick up goes where the camera looks. The target lies ahead by up to 5 m, as far as the stick is
    /// pushed; at rest there is none. The speed path's coordinate is the stick's deflection in [0, 1], and
    /// the right trigger adds the rest of the path; so does the left trigger to the stance path, which it
    /// chooses when pressed harder than the right. While the button of the style path is held, a pushed stick goes to the end of
    /// that path, whatever the triggers. Values that are not finite count as zero. Does not allocate.
    pub fn map(&mut self, pad: &GamepadState, camera: Heading, state: &CharacterState) -> Command {
        let stick = Vec2::from_array(pad.left_stick.map(finite)).clamp(Vec2::NEG_ONE, Vec2::ONE);
        let length = libm::sqrtf(stick.x * stick.x + stick.y * stick.y);
        let push = if length < STICK_THRESHOLD { 0.0 } else { length.min(1.0) };
        let target = (push > 0.0).then(|| {
            let ahead = camera.world_from_heading_2d(Vec2::new(stick.y, -stick.x) / length);
            state.body(Body::Pelvis).position.truncate() + ahead * (push * TARGET_RANGE_METRES)
        });
        let pressed = pad.buttons.pressed_since(self.last.buttons);
        self.last = *pad;
        Command {
            target,
            goal: self.goal(pad, push),
            skill: self.skills.iter().find(|(button, _)| pressed.contains(*button)).map(|(_, skill)| *skill),
            ..Command::default()
        }
    }

    /// Forgets which buttons were held.
    pub fn reset(&mut self) {
        self.last = GamepadState::default();
    }

    fn goal(&self, pad: &GamepadState, push: f32) -> Goal {
        let (left, right) = (finite(pad.left_trigger), finite(pad.right_trigger));
        // From the path's second node on, the trigger covers the rest.
        let along = |(path, end): (usize, f32), start: f32, trigger: f32| Goal::Path {
            path,
            coordinate: start + trigger.clamp(0.0, 1.0) * (end - 1.0).max(0.0),
        };
        let styled = self.style.filter(|_| push > 0.0 && pad.buttons.contains(self.style_button));
        if let Some((path, end)) = styled {
            return Goal::Path { path, coordinate: end };
        }
        match (self.speed, self.stance) {
            (_, Some(stance)) if left > TRIGGER_THRESHOLD && left >= right => along(stance, 1.0, left),
            (Some(speed), _) if push > 0.0 => along(speed, push, right),
            (Some((path, _)), _) => Goal::Path { path, coordinate: 0.0 },
            _ => Goal::Stay,
        }
    }
}

fn finite(value: f32) -> f32 {
    if value.is_finite() { value } else { 0.0 }
}
