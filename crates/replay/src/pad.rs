//! A pad in whole numbers: the only input of a simulation that is to be repeated.

use policy_core::{Button, Buttons, GamepadState, Heading};

/// What one player pressed in one control tick, and which way its camera looked. Ten bytes.
///
/// The right stick moves cameras, not characters, and is left out. Whoever records plays with [`Pad::state`] too, not with
/// the device's own numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Pad {
    /// x to the right, y up, each in steps of 1/127 from -127 to 127. -128 counts as -127.
    pub left_stick: [i8; 2],
    /// Left and right, in steps of 1/255.
    pub triggers: [u8; 2],
    /// Direction of the camera: parts of a turn in 1/65536, from world x, counter-clockwise seen from above.
    pub camera: u16,
    /// One bit for each button, in the order of [`Button::ALL`]. Other bits have no effect.
    pub buttons: u32,
}

/// Parts of a turn.
const TURN: f32 = 65536.0;

impl Pad {
    /// Bytes of [`Pad::to_bytes`].
    pub const BYTES: usize = 10;

    /// The nearest pad to a device's state, for a camera that looks along `camera`. Numbers that are not finite count as 0.
    #[must_use]
    pub fn from_state(state: &GamepadState, camera: Heading) -> Self {
        let turns = camera.angle() / core::f32::consts::TAU;
        let finite = |value: f32| if value.is_finite() { value } else { 0.0 };
        let stick = |value: f32| round(finite(value).clamp(-1.0, 1.0) * 127.0) as i8;
        let trigger = |value: f32| round(finite(value).clamp(0.0, 1.0) * 255.0) as u8;
        Self {
            left_stick: state.left_stick.map(stick),
            triggers: [trigger(state.left_trigger), trigger(state.right_trigger)],
            camera: (round(turns * TURN) as i32).rem_euclid(65536) as u16,
            buttons: state.buttons.bits(),
        }
    }

    /// The state for a command mapping.
    #[must_use]
    pub fn state(self) -> GamepadState {
        let mut buttons = Buttons::NONE;
        for button in Button::ALL {
            buttons.set(button, self.buttons & (1 << button as u8) != 0);
        }
        GamepadState {
            left_stick: self.left_stick.map(|value| f32::from(value.max(-127)) / 127.0),
            right_stick: [0.0; 2],
            left_trigger: f32::from(self.triggers[0]) / 255.0,
            right_trigger: f32::from(self.triggers[1]) / 255.0,
            buttons,
        }
    }

    /// Where the camera looks.
    #[must_use]
    pub fn heading(self) -> Heading {
        Heading::from_angle(f32::from(self.camera) / TURN * core::f32::consts::TAU)
    }

    /// Its bytes, in the order of the fields, little-endian.
    #[must_use]
    pub fn to_bytes(self) -> [u8; Self::BYTES] {
        let [x, y] = self.left_stick.map(|value| value as u8);
        let [left, right] = self.triggers;
        let [c0, c1] = self.camera.to_le_bytes();
        let [b0, b1, b2, b3] = self.buttons.to_le_bytes();
        [x, y, left, right, c0, c1, b0, b1, b2, b3]
    }

    /// The pad of these bytes. Any ten bytes are one.
    #[must_use]
    pub fn from_bytes(bytes: [u8; Self::BYTES]) -> Self {
        let [x, y, left, right, c0, c1, b0, b1, b2, b3] = bytes;
        Self {
            left_stick: [x as i8, y as i8],
            triggers: [left, right],
            camera: u16::from_le_bytes([c0, c1]),
            buttons: u32::from_le_bytes([b0, b1, b2, b3]),
        }
    }
}

/// To the nearest whole number, halves away from zero: additions and casts only, so the same everywhere.
fn round(value: f32) -> f32 {
    (value + 0.5_f32.copysign(value)).trunc()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pad_that_was_made_of_a_pad_is_the_same() {
        for step in 0..=u16::MAX {
            let byte = (step % 251) as u8;
            let pad = Pad {
                left_stick: [(byte / 2) as i8, -((byte / 2) as i8)],
                triggers: [byte, 255 - byte],
                camera: step,
                buttons: u32::from(step) & 0x7_ffff,
            };
            let again = Pad::from_state(&pad.state(), pad.heading());
            assert_eq!(again.camera.wrapping_sub(pad.camera).wrapping_add(1) / 3, 0, "{pad:?} {again:?}");
            assert_eq!(Pad { camera: pad.camera, ..again }, pad);
            assert_eq!(Pad::from_bytes(pad.to_bytes()), pad);
        }
    }

    #[test]
    fn broken_numbers_are_a_pad_at_rest() {
        let broken = GamepadState {
            left_stick: [f32::NAN, 4.0],
            left_trigger: f32::INFINITY,
            right_trigger: -3.0,
            ..GamepadState::default()
        };
        let pad = Pad::from_state(&broken, Heading::FORWARD);
        assert_eq!((pad.left_stick, pad.triggers, pad.camera), ([0, 127], [0, 0], 0));
        let endless = GamepadState { left_stick: [f32::INFINITY, f32::NEG_INFINITY], ..broken };
        assert_eq!(Pad::from_state(&endless, Heading::FORWARD).left_stick, [0, 0]);
        assert_eq!(Pad { left_stick: [-128, 0], ..Pad::default() }.state().left_stick, [-1.0, 0.0]);
    }
}
