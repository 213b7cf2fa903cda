//! From a gamepad to a command: the left stick sets the target, analog controls run along paths, buttons
//! request skills (paper, section 3.6).

use alloc::vec::Vec;

use glam::Vec2;

use crate::bindings::{Bindings, Control, Curve};
use crate::command::{Command, Goal};
use crate::gamepad_state::{Button, GamepadState};
use crate::heading::Heading;
use crate::ids::{PathId, SkillId};
use crate::observation::TARGET_RANGE_METRES;
use crate::pack::CharacterPack;
use crate::state::CharacterState;

/// A path that a control moves along.
#[derive(Clone, Copy, Debug)]
struct BoundPath {
    path: PathId,
    end: f32,
    control: Control,
    first: f32,
    needs_stick: bool,
    /// True when the policy at its end strafes: then the character faces where the camera looks.
    strafes: bool,
}

/// Maps gamepads to commands. Remembers which buttons were held: one mapper for each player.
#[derive(Clone, Debug)]
pub struct CommandMapper {
    stick_path: Option<(PathId, f32)>,
    faster: Control,
    paths: Vec<BoundPath>,
    skills: Vec<(Button, SkillId)>,
    stick: Curve,
    trigger: Curve,
    last: GamepadState,
}

impl CommandMapper {
    /// A mapper for the paths and skills of `pack`. Bindings to names that the pack lacks do nothing.
    #[must_use]
    pub fn new(pack: &CharacterPack, bindings: &Bindings) -> Self {
        let path = |name: &str| {
            let id = pack.graph().path_named(name)?;
            Some((id, pack.graph().path(id).end()))
        };
        let strafes = |path: PathId| {
            pack.graph().path(path).nodes().last().is_some_and(|node| pack.graph().node(*node).strafes)
        };
        let bound = bindings.paths.iter().filter_map(|binding| {
            let (path, end) = path(&binding.path)?;
            let first = binding.first.clamp(0.0, end);
            let (control, needs_stick) = (binding.control, binding.needs_stick);
            Some(BoundPath { path, end, control, first, needs_stick, strafes: strafes(path) })
        });
        let skill =
            |(button, name): &(Button, alloc::string::String)| Some((*button, pack.skill_named(name)?));
        Self {
            stick_path: path(&bindings.stick_path),
            faster: bindings.faster,
            paths: bound.collect(),
            skills: bindings.skills.iter().filter_map(skill).collect(),
            stick: bindings.stick,
            trigger: bindings.trigger,
            last: GamepadState::default(),
        }
    }

    /// The command of a pad, for a camera that looks along `camera`.
    ///
    /// Stick up goes where the camera looks. The target lies ahead by up to 5 m, as far as the stick is
    /// pushed; at rest there is none. The bound path whose control is pressed hardest sets the goal, the earlier one of two.
    /// While that path leads to a policy that strafes, the character faces where the camera looks.
    /// Otherwise the stick moves along its own path: its deflection in [0, 1], and the faster control adds the
    /// rest of the path. Values that are not finite count as zero. Does not allocate.
    ///
    /// # Panics
    /// When `state` has no body.
    pub fn map(&mut self, pad: &GamepadState, camera: Heading, state: &CharacterState) -> Command {
        let stick = Vec2::from_array(pad.left_stick.map(finite)).clamp(Vec2::NEG_ONE, Vec2::ONE);
        let length = libm::sqrtf(stick.x * stick.x + stick.y * stick.y);
        let push = self.stick.apply(length.min(1.0));
        let target = (push > 0.0).then(|| {
            let ahead = camera.world_from_heading_2d(Vec2::new(stick.y, -stick.x) / length);
            state.root().position.truncate() + ahead * (push * TARGET_RANGE_METRES)
        });
        let pressed = pad.buttons.pressed_since(self.last.buttons);
        self.last = *pad;
        let hardest = self.hardest(pad, push);
        Command {
            target,
            facing: hardest.filter(|(_, bound)| bound.strafes).map(|_| camera.direction()),
            goal: self.goal(pad, push, hardest),
            skill: self.skills.iter().find(|(button, _)| pressed.contains(*button)).map(|(_, skill)| *skill),
            ..Command::default()
        }
    }

    /// Forgets which buttons were held.
    pub fn reset(&mut self) {
        self.last = GamepadState::default();
    }

    fn value(&self, control: Control, pad: &GamepadState) -> f32 {
        match control {
            Control::LeftTrigger => self.trigger.apply(finite(pad.left_trigger).clamp(0.0, 1.0)),
            Control::RightTrigger => self.trigger.apply(finite(pad.right_trigger).clamp(0.0, 1.0)),
            Control::Button(button) => f32::from(u8::from(pad.buttons.contains(button))),
            Control::None => 0.0,
        }
    }

    /// The bound path whose control is pressed hardest, and how hard.
    fn hardest(&self, pad: &GamepadState, push: f32) -> Option<(f32, &BoundPath)> {
        let faster = self.value(self.faster, pad);
        let mut hardest: Option<(f32, &BoundPath)> = None;
        for bound in self.paths.iter().filter(|bound| push > 0.0 || !bound.needs_stick) {
            let value = self.value(bound.control, pad);
            let rival = hardest.map_or(0.0, |(value, _)| value);
            if value > rival && (matches!(bound.control, Control::Button(_)) || value >= faster) {
                hardest = Some((value, bound));
            }
        }
        hardest
    }

    fn goal(&self, pad: &GamepadState, push: f32, hardest: Option<(f32, &BoundPath)>) -> Goal {
        let along = |path: PathId, first: f32, end: f32, value: f32| Goal::Path {
            path,
            coordinate: first + value * (end - first).max(0.0),
        };
        let faster = self.value(self.faster, pad);
        match (hardest, self.stick_path) {
            (Some((value, bound)), _) => along(bound.path, bound.first, bound.end, value),
            (None, Some((path, end))) if push > 0.0 => along(path, push, end - 1.0 + push, faster),
            (None, Some((path, _))) => Goal::Path { path, coordinate: 0.0 },
            (None, None) => Goal::Stay,
        }
    }
}

fn finite(value: f32) -> f32 {
    if value.is_finite() { value } else { 0.0 }
}
