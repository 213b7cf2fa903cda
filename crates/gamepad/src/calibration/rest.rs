//! Measuring where a pad rests.

use super::{Calibration, DeadZones, Rest, Zone};
use crate::GamepadState;

/// Furthest that a stick of a usable pad rests from its centre.
const MOST_DRIFT: f32 = 0.3;
/// Furthest that a trigger of a usable pad rests from released.
const MOST_PULL: f32 = 0.3;
/// Most that a control at rest moves to and fro.
const MOST_SPREAD: f32 = 0.15;
/// The dead zone reaches this many times as far as the control moved while measured, plus a little.
const SPREAD_MARGIN: f32 = 1.5;
const LITTLE: f32 = 0.02;

/// Watches a pad that lies at rest and finds where its controls rest and how much they move there.
#[derive(Clone, Debug)]
pub struct RestCalibrator {
    samples: u32,
    low: [f32; 6],
    high: [f32; 6],
}

/// Why a measurement was refused: somebody held the pad, or it is broken.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NotAtRest {
    /// Not enough reports to tell.
    #[error("expected at least {} reports, found {found}", RestCalibrator::LEAST_SAMPLES)]
    TooFew {
        /// Reports seen.
        found: u32,
    },
    /// A control was off its rest position or moved.
    #[error("{control}: expected it at rest, found it between {low} and {high}")]
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

    /// Takes one raw state.
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

    /// The rest positions, and `zones` widened where a control moved more than they forgive.
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
