//! States and calibrations as bytes.

use crate::calibration::{Calibration, DeadZones, Rest, Zone};
use crate::{Button, Buttons, GamepadState};

/// Four stick axes, two triggers, buttons.
const STATE_LEN: usize = 28;
/// Rest positions of the six, then inner and outer thresholds of both sticks and both triggers.
pub(super) const CALIBRATION_LEN: usize = 56;

pub(super) fn encode_state(state: &GamepadState) -> [u8; STATE_LEN] {
    let [lx, ly] = state.left_stick;
    let [rx, ry] = state.right_stick;
    let mut bytes = [0; STATE_LEN];
    let axes = [lx, ly, rx, ry, state.left_trigger, state.right_trigger];
    for (chunk, axis) in bytes.chunks_exact_mut(4).zip(axes) {
        chunk.copy_from_slice(&axis.to_le_bytes());
    }
    bytes[24..].copy_from_slice(&state.buttons.bits().to_le_bytes());
    bytes
}

/// `None` for a wrong length and for values outside their ranges.
pub(super) fn decode_state(bytes: &[u8]) -> Option<GamepadState> {
    let bytes: &[u8; STATE_LEN] = bytes.try_into().ok()?;
    // Axes 0 to 5 take the first 24 bytes, the buttons the last 4.
    let axis =
        |i: usize| f32::from_le_bytes([bytes[4 * i], bytes[4 * i + 1], bytes[4 * i + 2], bytes[4 * i + 3]]);
    let bits = u32::from_le_bytes([bytes[24], bytes[25], bytes[26], bytes[27]]);
    let mut buttons = Buttons::NONE;
    for button in Button::ALL {
        buttons.set(button, bits >> button as u8 & 1 == 1);
    }
    let sticks = (0..4).all(|i| (-1.0..=1.0).contains(&axis(i)));
    let triggers = (4..6).all(|i| (0.0..=1.0).contains(&axis(i)));
    (sticks && triggers && buttons.bits() == bits).then(|| GamepadState {
        left_stick: [axis(0), axis(1)],
        right_stick: [axis(2), axis(3)],
        left_trigger: axis(4),
        right_trigger: axis(5),
        buttons,
    })
}

pub(super) fn encode_calibration(calibration: &Calibration) -> [u8; CALIBRATION_LEN] {
    let Calibration { rest, zones } = calibration;
    let sticks = [rest.left_stick, rest.right_stick].into_iter().flatten();
    let thresholds = [zones.left_stick, zones.right_stick, zones.left_trigger, zones.right_trigger]
        .into_iter()
        .flat_map(|zone| [zone.inner(), zone.outer()]);
    let values = sticks.chain([rest.left_trigger, rest.right_trigger]).chain(thresholds);
    let mut bytes = [0; CALIBRATION_LEN];
    for (chunk, value) in bytes.chunks_exact_mut(4).zip(values) {
        chunk.copy_from_slice(&value.to_le_bytes());
    }
    bytes
}

/// `None` for a wrong length, rest positions beyond [-0.5, 0.5], and invalid thresholds.
pub(super) fn decode_calibration(bytes: &[u8]) -> Option<Calibration> {
    let bytes: &[u8; CALIBRATION_LEN] = bytes.try_into().ok()?;
    // 14 values of 4 bytes; the last zone takes values 12 and 13.
    let value =
        |i: usize| f32::from_le_bytes([bytes[4 * i], bytes[4 * i + 1], bytes[4 * i + 2], bytes[4 * i + 3]]);
    let zone = |i: usize| Zone::new(value(6 + 2 * i), value(7 + 2 * i)).ok();
    let near_rest = (0..6).all(|i| (-0.5..=0.5).contains(&value(i)));
    let rest = Rest {
        left_stick: [value(0), value(1)],
        right_stick: [value(2), value(3)],
        left_trigger: value(4),
        right_trigger: value(5),
    };
    let zones = DeadZones {
        left_stick: zone(0)?,
        right_stick: zone(1)?,
        left_trigger: zone(2)?,
        right_trigger: zone(3)?,
    };
    near_rest.then_some(Calibration { rest, zones })
}
