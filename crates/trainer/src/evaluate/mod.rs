//! Measures of a pack, through the same controller as a game: survival along paths, reached speed, get-up, roll,
//! pushes, distances between parameters, and how a motion looks beside its clip.

mod layers;
mod motion;
mod paths;
mod push;
mod report;
mod skills;
mod subject;
mod upright;

pub use layers::{LayerReport, measure_layers, watch_layers};
pub use motion::{MotionReport, STANCE_METRES, clip_states, pose_error, watch};
pub use paths::{measure_coordinates, measure_sweep};
pub use push::measure_push;
pub use report::{Evaluation, ModeReport, PathReport, PushReport, SpeedPoint, evaluate};
pub use skills::{RateReport, measure_get_up, measure_skill, watch_skill};
pub use subject::{Subject, Wanderer};
pub use upright::{UprightReport, measure_upright};

/// How much is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Characters in a measure of survival.
    pub characters: usize,
    /// Seconds each of them walks.
    pub secs: f32,
    /// Characters in a measure of survival on uneven ground.
    pub characters_uneven: usize,
    /// Coordinates along a path.
    pub coordinates: usize,
    /// Characters at each coordinate.
    pub characters_each: usize,
    /// Ragdoll drops and rolls.
    pub drops: usize,
    /// Characters that are pushed at each force.
    pub pushed: usize,
    /// Characters for each choice of layers.
    pub layered: usize,
}

impl Effort {
    /// What figures are published from.
    pub const FULL: Effort = Effort {
        characters: 256,
        characters_uneven: 64,
        secs: 60.0,
        coordinates: 11,
        characters_each: 32,
        drops: 1000,
        pushed: 64,
        layered: 16,
    };

    /// Less than a minute on two idle cores, for a first look.
    pub const QUICK: Effort = Effort {
        characters: 32,
        characters_uneven: 8,
        secs: 20.0,
        coordinates: 5,
        characters_each: 8,
        drops: 64,
        pushed: 5,
        layered: 1,
    };
}
