//! From raw controls to a pad's state: rest positions and dead zones.
//!
//! Sticks have a radial dead zone: 0 inside `inner`, 1 outside `outer`, linear between, so that there is no jump and
//! the direction is kept. Triggers have the same on one axis.

mod rest;

pub use rest::{NotAtRest, RestCalibrator};

use crate::GamepadState;

/// An inner and an outer threshold: values up to `inner` become 0, from `outer` on 1, linear between.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Zone {
    inner: f32,
    outer: f32,
}

/// Why a pair of thresholds was refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("dead zone: expected 0 <= inner < outer <= 1, found inner {inner} and outer {outer}")]
pub struct ZoneError {
    /// Inner threshold found.
    pub inner: f32,
    /// Outer threshold found.
    pub outer: f32,
}

impl Zone {
    /// Thresholds with `0 <= inner < outer <= 1`.
    ///
    /// # Errors
    /// [`ZoneError`] for anything else, NaN included.
    pub fn new(inner: f32, outer: f32) -> Result<Self, ZoneError> {
        let sound = 0.0 <= inner && inner < outer && outer <= 1.0;
        if sound { Ok(Self { inner, outer }) } else { Err(ZoneError { inner, outer }) }
    }

    /// Lower threshold.
    #[must_use]
    pub fn inner(self) -> f32 {
        self.inner
    }

    /// Upper threshold.
    #[must_use]
    pub fn outer(self) -> f32 {
        self.outer
    }

    /// This zone with an inner threshold of at least `inner`, limited by the outer one.
    fn widened(self, inner: f32) -> Self {
        let most = (self.outer - 0.05).max(self.inner);
        Self { inner: self.inner.max(inner.min(most)), ..self }
    }

    /// Rescales a magnitude to [0, 1]; 0 if it is not finite.
    #[must_use]
    pub fn rescaled(self, magnitude: f32) -> f32 {
        if !magnitude.is_finite() {
            return 0.0;
        }
        ((magnitude - self.inner) / (self.outer - self.inner)).clamp(0.0, 1.0)
    }
}

/// The thresholds of a pad's four analog controls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeadZones {
    /// Left stick, radial.
    pub left_stick: Zone,
    /// Right stick, radial.
    pub right_stick: Zone,
    /// Left trigger.
    pub left_trigger: Zone,
    /// Right trigger.
    pub right_trigger: Zone,
}

impl Default for DeadZones {
    fn default() -> Self {
        const STICK: Zone = Zone { inner: 0.1, outer: 0.95 };
        const TRIGGER: Zone = Zone { inner: 0.04, outer: 0.97 };
        Self { left_stick: STICK, right_stick: STICK, left_trigger: TRIGGER, right_trigger: TRIGGER }
    }
}

/// Rest positions of a pad's analog controls, in raw units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rest {
    /// Left stick.
    pub left_stick: [f32; 2],
    /// Right stick.
    pub right_stick: [f32; 2],
    /// Left trigger.
    pub left_trigger: f32,
    /// Right trigger.
    pub right_trigger: f32,
}

/// Rest positions and dead zones of one pad.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Calibration {
    /// Rest positions; zero until measured.
    pub rest: Rest,
    /// Thresholds around the rest positions.
    pub zones: DeadZones,
}

impl Calibration {
    /// The state after calibration and dead zones: sticks within the unit circle, triggers in [0, 1].
    #[must_use]
    pub fn state(&self, raw: &GamepadState) -> GamepadState {
        let (rest, zones) = (&self.rest, &self.zones);
        GamepadState {
            left_stick: stick(raw.left_stick, rest.left_stick, zones.left_stick),
            right_stick: stick(raw.right_stick, rest.right_stick, zones.right_stick),
            left_trigger: trigger(raw.left_trigger, rest.left_trigger, zones.left_trigger),
            right_trigger: trigger(raw.right_trigger, rest.right_trigger, zones.right_trigger),
            buttons: raw.buttons,
        }
    }
}

/// Stretches each half of an axis, so that its end stays at 1 for any rest position.
fn from_rest(value: f32, rest: f32) -> f32 {
    let reach = if value < rest { 1.0 + rest } else { 1.0 - rest };
    (value - rest) / reach.max(0.1)
}

fn stick(raw: [f32; 2], rest: [f32; 2], zone: Zone) -> [f32; 2] {
    let [x, y] = [from_rest(raw[0], rest[0]), from_rest(raw[1], rest[1])];
    let magnitude = x.hypot(y);
    let rescaled = zone.rescaled(magnitude);
    if rescaled == 0.0 { [0.0; 2] } else { [x, y].map(|v| (v / magnitude * rescaled).clamp(-1.0, 1.0)) }
}

fn trigger(raw: f32, rest: f32, zone: Zone) -> f32 {
    zone.rescaled((raw - rest) / (1.0 - rest).max(0.1))
}
