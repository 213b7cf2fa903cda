//! Why a world can't be changed as asked.

use policy_core::contract::{DescriptionError, PoseError, PushError};

use super::file::quoted;
use super::model_error::ModelError;

/// Why a [`World`](crate::World) refuses a change. The world is then as it was.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WorldError {
    /// The handle is of something that was removed, or of another world.
    #[error("expected the handle of {what} that is in the world, found one of something that is not")]
    Stale {
        /// `a prop`, `a fixture`, `a joint`, `a character` or `a grab`.
        what: &'static str,
    },
    /// A character runs at another rate than the world.
    #[error(
        "expected a character of {control_hz} ticks a second that bears steps of {timestep_secs} s, found one of \
         {found_control_hz} and {found_timestep_secs} s: make the world of the model with the shortest steps"
    )]
    Rate {
        /// The world's control ticks per second.
        control_hz: f32,
        /// The world's physics step, seconds.
        timestep_secs: f64,
        /// The character's control ticks per second.
        found_control_hz: f32,
        /// The character's physics step, seconds.
        found_timestep_secs: f64,
    },
    /// The model differs in more than its settings.
    #[error("expected a model made by `with_settings` of the present one, found another")]
    OtherModel,
    /// A character's geoms use too many contact bits.
    #[error("expected contype and conaffinity to use at most {most} bits, found {found}")]
    ContactBits {
        /// Most.
        most: u32,
        /// Found.
        found: u32,
    },
    /// A joint would make a prop hold itself.
    #[error(
        "expected a prop that is free or holds the other one by no joint, found a joint that closes a loop"
    )]
    Loop,
    /// A prop on a joint can't be placed.
    #[error("expected a prop without a joint, found one that hangs on a joint")]
    Jointed,
    /// A character can't be posed like that.
    #[error(transparent)]
    Pose(#[from] PoseError),
    /// A push that is out of its limits.
    #[error(transparent)]
    Push(#[from] PushError),
    /// Something that can't be as described: a number out of its range, for instance.
    #[error(transparent)]
    Description(#[from] DescriptionError),
    /// A character's model can't be loaded.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// MuJoCo refuses what was put together.
    #[error("expected a world that compiles, found: {}", quoted(message))]
    Compile {
        /// MuJoCo's words.
        message: String,
    },
}
