//! Measures the rest position of a pad's controls.

use super::{Calibration, DeadZones, Rest, Zone};
use crate::GamepadState;

/// Greatest rest offset of a usable stick.
const MOST_DRIFT: f32 = 0.3;
/// Greatest rest offset of a usable trigger.
const MOST_PULL: f32 = 0.3;
/// Greatest movement of a control at rest.
const MOST_SPREAD: f32 = 0.15;
/// Factor from the movement at rest to the dead zone; a small margin is added.
const SPREAD_MARGIN: f32 = 1.5;
const LITTLE: f32 = 0.02;

/// Measures the rest positions of a pad's controls and how much they move at rest.
#[derive(Clone, Debug)]
pub struct RestCalibrator {
    samples: u32,
    low: [f32; 6],
    high: [f32; 6],
}

/// Why a measurement was refused: the pad was held, or it is defective.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NotAtRest {
    /// There were too few reports.
    #[error("expected at least {} reports, found {found}", RestCalibrator::LEAST_SAMPLES)]
    TooFew {
        /// Reports seen.
        found: u32,
    },
    /// A control moved or was away from its rest position.
    #[error("{control}: expected a control at rest, found values from {low} to {high}")]
    Moved {
        /// Name of the control.
        control: &'static str,
        /// Least value seen.
        low: f32,
        /// Greatest value seen.
        high: f32,
    },
}

impl Default for RestCalibrator {
    fn default() -> Self {
        Self { samples: 0, low: [f32::INFINITY; 6], high: [f32::NEG_INFINITY; 6] }
    }
}

impl RestCalibrator {
    /// Reports needed for a result.
    pub const LEAST_SAMPLES: u32 = 20;

    /// Adds one raw state.
    pub fn observe(&mut self, raw: &GamepadState) {
        let values = [
            raw.left_stick[0],
            raw.left_stick[1],
            raw.right_stick[0],
            raw.right_stick[1],
            raw.left_trigger,
            raw.right_trigger,
        ];
        for (i, value) in values.into_iter().enumerate() {
            self.low[i] = self.low[i].min(value);
            self.high[i] = self.high[i].max(value);
        }
        self.samples = self.samples.saturating_add(1);
    }

    /// The rest positions, and `zones` widened where a control moves more than they allow.
    ///
    /// # Errors
    /// [`NotAtRest`] when there were too few reports or a control was held.
    pub fn finish(&self, zones: DeadZones) -> Result<Calibration, NotAtRest> {
        const NAMES: [&str; 6] = [
            "left stick x",
            "left stick y",
            "right stick x",
            "right stick y",
            "left trigger",
            "right trigger",
        ];
        if self.samples < Self::LEAST_SAMPLES {
            return Err(NotAtRest::TooFew { found: self.samples });
        }
        for (i, control) in NAMES.into_iter().enumerate() {
            let (low, high) = (self.low[i], self.high[i]);
            let most = if i < 4 { MOST_DRIFT } else { MOST_PULL };
            let at_rest = low >= -most && high <= most && high - low <= MOST_SPREAD;
            if !at_rest {
                return Err(NotAtRest::Moved { control, low, high });
            }
        }
        let rest = |i: usize| (self.low[i] + self.high[i]) / 2.0;
        let spread = |i: usize| (self.high[i] - self.low[i]) / 2.0 * SPREAD_MARGIN;
        let stick =
            |zone: Zone, i: usize| zone.widened(spread(i).hypot(spread(i + 1)) / (1.0 - MOST_DRIFT) + LITTLE);
        let trigger = |zone: Zone, i: usize| zone.widened(spread(i) / (1.0 - MOST_PULL) + LITTLE);
        Ok(Calibration {
            rest: Rest {
                left_stick: [rest(0), rest(1)],
                right_stick: [rest(2), rest(3)],
                left_trigger: rest(4),
                right_trigger: rest(5),
            },
            zones: DeadZones {
                left_stick: stick(zones.left_stick, 0),
                right_stick: stick(zones.right_stick, 2),
                left_trigger: trigger(zones.left_trigger, 4),
                right_trigger: trigger(zones.right_trigger, 5),
            },
        })
    }
}
