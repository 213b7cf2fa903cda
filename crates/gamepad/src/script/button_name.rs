//! The buttons as written in a script.

use serde::Deserialize;

use crate::Button;

/// [`Button`] as written in a script; the same names in the same order.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(rename = "Button")]
pub(super) enum ButtonName {
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

impl ButtonName {
    pub(super) fn button(self) -> Button {
        Button::ALL[self as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_written_names_are_those_of_the_buttons() {
        for button in Button::ALL {
            let name: ButtonName = ron::from_str(&format!("{button:?}")).expect("a button's name");
            assert_eq!(name.button(), button);
        }
    }
}
