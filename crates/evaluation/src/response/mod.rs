//! How a character responds to the stick: turns, starts, stops, and the way straight ahead.

mod start;
mod stop;
mod strafe;
mod straight;
mod turn;

pub use start::{StartReport, measure_starts};
pub(super) use stop::NOMINAL_SECS as STOP_SECS;
pub use stop::{StopReport, measure_stops};
pub(crate) use strafe::WAYS;
pub use strafe::{StrafeReport, measure_strafe};
pub use straight::{StraightPoint, commanded_mps, measure_straight};
pub use turn::{TURNS_DEGREES, TurnDetector, TurnReport, measure_turns};
