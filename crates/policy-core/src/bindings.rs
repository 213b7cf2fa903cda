//! Which control of a gamepad does what, by names of the pack.

use alloc::string::String;
use alloc::vec::Vec;

use crate::gamepad_state::Button;

/// A control that moves along a path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Control {
    /// The analog left trigger.
    LeftTrigger,
    /// The analog right trigger.
    RightTrigger,
    /// A button, held: all of the way.
    Button(Button),
    /// Nothing.
    #[default]
    None,
}

/// Response of an analog control: `((value - dead_zone) / (1 - dead_zone))^exponent` if `exponent` is not 1, else the value
/// itself above the dead zone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curve {
    /// Values up to this count as 0; in [0, 1).
    pub dead_zone: f32,
    /// Above 1 for finer control near rest; above 0.
    pub exponent: f32,
}

impl Curve {
    /// The response to a value in [0, 1], in [0, 1].
    #[must_use]
    pub fn apply(self, value: f32) -> f32 {
        if value.is_nan() || value < self.dead_zone || value <= 0.0 {
            return 0.0;
        }
        if self.exponent == 1.0 {
            return value.min(1.0);
        }
        let above = ((value - self.dead_zone) / (1.0 - self.dead_zone)).clamp(0.0, 1.0);
        let response = libm::powf(above, self.exponent);
        if response.is_finite() { response.clamp(0.0, 1.0) } else { 0.0 }
    }
}

/// A path and the control that moves along it.
#[derive(Clone, Debug, PartialEq)]
pub struct PathBinding {
    /// Name of the path.
    pub path: String,
    /// The control: at rest the path is not taken.
    pub control: Control,
    /// Coordinate of the lightest press; a full press is the end of the path.
    pub first: f32,
    /// True for a path that is taken only while the stick is pushed.
    pub needs_stick: bool,
}

/// Which control does what. Names that a pack lacks do nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct Bindings {
    /// Path of the stick: its first node for a stick at rest, its second for a full stick.
    pub stick_path: String,
    /// Control that covers the rest of that path.
    pub faster: Control,
    /// Paths with controls of their own.
    pub paths: Vec<PathBinding>,
    /// Buttons and the skills that they request.
    pub skills: Vec<(Button, String)>,
    /// Response of the stick.
    pub stick: Curve,
    /// Response of the triggers.
    pub trigger: Curve,
}

impl Default for Bindings {
    /// Stick and right trigger `speed`, left trigger `stance`, right shoulder `style`, right stick pressed `strafe`; south `get_up`, east `roll`, north
    /// `jump`, west `punch`.
    fn default() -> Self {
        let skills = [
            (Button::South, "get_up"),
            (Button::East, "roll"),
            (Button::North, "jump"),
            (Button::West, "punch"),
        ];
        let [style, strafe] = [Button::RightShoulder, Button::RightStick].map(Control::Button);
        Self {
            stick_path: "speed".into(),
            faster: Control::RightTrigger,
            paths: alloc::vec![
                PathBinding { path: "strafe".into(), control: strafe, first: 2.0, needs_stick: false },
                PathBinding { path: "style".into(), control: style, first: 1.0, needs_stick: true },
                PathBinding {
                    path: "stance".into(),
                    control: Control::LeftTrigger,
                    first: 1.0,
                    needs_stick: false
                },
            ],
            skills: skills.into_iter().map(|(b, name)| (b, name.into())).collect(),
            stick: Curve { dead_zone: 0.05, exponent: 1.0 },
            trigger: Curve { dead_zone: 0.02, exponent: 1.0 },
        }
    }
}
