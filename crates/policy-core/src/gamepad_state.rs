//! The plain state of a gamepad: the contract between whatever reads devices (or keys, or a script)
//! and the command mapping.

use serde::{Deserialize, Serialize};

/// Buttons of a gamepad, named by place so that no maker's letters matter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[repr(u8)]
#[expect(missing_docs, reason = "the names say it all")]
pub enum Button {
    South,
    East,
    West,
    North,
    LeftShoulder,
    RightShoulder,
    LeftTrigger,
    RightTrigger,
    LeftStick,
    RightStick,
    Select,
    Start,
    Guide,
    DpadUp,
    DpadDown,
    DpadLeft,
    DpadRight,
    Touchpad,
    Misc,
}

impl Button {
    /// All buttons in bit order.
    pub const ALL: [Button; 19] = [
        Button::South,
        Button::East,
        Button::West,
        Button::North,
        Button::LeftShoulder,
        Button::RightShoulder,
        Button::LeftTrigger,
        Button::RightTrigger,
        Button::LeftStick,
        Button::RightStick,
        Button::Select,
        Button::Start,
        Button::Guide,
        Button::DpadUp,
        Button::DpadDown,
        Button::DpadLeft,
        Button::DpadRight,
        Button::Touchpad,
        Button::Misc,
    ];
}

/// A set of pressed [`Button`]s.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Buttons(u32);

impl Buttons {
    /// No button pressed.
    pub const NONE: Buttons = Buttons(0);

    /// True while `button` is held.
    #[must_use]
    pub const fn contains(self, button: Button) -> bool {
        self.0 & (1 << button as u8) != 0
    }

    /// Presses or releases `button`.
    pub fn set(&mut self, button: Button, pressed: bool) {
        let bit = 1 << button as u8;
        self.0 = if pressed { self.0 | bit } else { self.0 & !bit };
    }

    /// This set with `button` pressed as well.
    #[must_use]
    pub const fn with(self, button: Button) -> Self {
        Self(self.0 | (1 << button as u8))
    }

    /// Buttons held now that were not held in `before`.
    #[must_use]
    pub const fn pressed_since(self, before: Buttons) -> Buttons {
        Buttons(self.0 & !before.0)
    }

    /// One bit for each button, in the order of [`Button::ALL`].
    #[must_use]
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// True when no button is held.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }
}

/// State of a gamepad after dead zones. Neutral is all zero, which is also [`Default`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GamepadState {
    /// x to the right, y up (away from the player), each in [-1, 1].
    pub left_stick: [f32; 2],
    /// x to the right, y up, each in [-1, 1].
    pub right_stick: [f32; 2],
    /// 0 released, 1 fully pressed.
    pub left_trigger: f32,
    /// 0 released, 1 fully pressed.
    pub right_trigger: f32,
    /// Buttons held.
    pub buttons: Buttons,
}
