//! What a character survives: a pad at random, uneven ground, a body and a world that differ from training, pushes.

mod bisect;
mod get_up;
mod pushes;
mod random_pad;
mod restless;
mod roam;
mod robustness;
mod terrain;

pub use bisect::largest;
pub use get_up::{GetUpReport, measure_get_up_on_terrain};
pub use pushes::{SidesReport, measure_pushes};
pub use random_pad::{PadKind, RandomPadReport, measure_random_pad};
pub use roam::FallReport;
pub use robustness::{CaseList, Cases, measure_robustness};
pub use terrain::{GroundList, Grounds, measure_terrain};

pub(super) use get_up::NOMINAL_SECS as GET_UP_SECS;
pub(super) use pushes::nominal_trials;
