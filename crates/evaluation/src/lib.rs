//! Measures of a pack, through the same controller as a game: survival along paths, reached speed, get-up, roll,
//! pushes, distances between parameters, how a motion looks beside its clip, and what a player feels: turns, starts, stops, drift.
//!
//! [`strip`] draws motions beside their clips, [`maps`] draws policies by their principal components, and [`compare`] has
//! the cost of a control step. Nothing here learns.

mod chosen;
pub mod compare;
mod effort;
pub mod encounters;
mod error;
mod eval_character;
mod layers;
pub mod legs;
pub mod maps;
mod motion;
mod paths;
mod player;
pub mod plots;
pub mod press;
mod progress;
mod push;
mod report;
pub mod response;
mod rig;
mod section;
mod skills;
#[cfg(test)]
mod smoke_tests;
pub mod stress;
pub mod strip;
mod table;
pub mod trial;
mod upright;

pub use chosen::{Chosen, Named};
pub use effort::Effort;
pub use error::EvaluationError;
pub use eval_character::{EvalCharacter, Wanderer};
pub use layers::{LayerReport, measure_layers, watch_layers};
pub use motion::{MotionReport, STANCE_METRES, clip_states, pose_error, watch};
pub use paths::{measure_coordinates, measure_sweep};
pub use player::{PlayerReport, ResponseReport};
pub use progress::Progress;
pub use push::measure_push;
pub use report::{Evaluation, ModeReport, PathReport, PushReport, SpeedPoint, evaluate};
pub use rig::Rig;
pub use section::Section;
pub use skills::{RateReport, SkillReport, measure_get_up, measure_skill, watch_skill};
pub use table::table;
pub use upright::{UprightReport, measure_upright};
