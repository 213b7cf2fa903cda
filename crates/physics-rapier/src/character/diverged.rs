//! What motion is implausible, and the error that says so.

use policy_core::contract::{MAX_DEPTH_M, MAX_DISTANCE_M, MAX_SPEED_MPS, MAX_SPIN_RADPS};
use policy_core::{CharacterState, Skeleton};

/// What was implausible.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Cause {
    /// A number is not finite.
    NotFinite,
    /// Faster than [`MAX_SPEED_MPS`].
    TooFast,
    /// Spins faster than [`MAX_SPIN_RADPS`].
    SpinsTooFast,
    /// Deeper than [`MAX_DEPTH_M`].
    BelowGround,
    /// Farther than [`MAX_DISTANCE_M`].
    TooFarAway,
}

/// The physics diverged.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("in tick {tick}: expected at most {limit} of body \"{body}\", found {found} ({cause:?})")]
#[non_exhaustive]
pub struct Diverged {
    /// Control ticks completed before.
    pub tick: u64,
    /// What was implausible.
    pub cause: Cause,
    /// Name of the body.
    pub body: String,
    /// The limit, in the unit of the cause.
    pub limit: f32,
    /// The value.
    pub found: f32,
}

impl Diverged {
    /// Finds the first body of a sensed state that moves implausibly. `tick` is what an error says.
    ///
    /// # Errors
    /// When a number is not finite or beyond a limit, such as [`MAX_SPEED_MPS`].
    pub fn check(skeleton: &Skeleton, state: &CharacterState, tick: u64) -> Result<(), Self> {
        for (body, motion) in skeleton.bodies().iter().zip(&state.bodies) {
            let sizes = [
                (Cause::TooFast, MAX_SPEED_MPS, motion.linear_velocity.length()),
                (Cause::SpinsTooFast, MAX_SPIN_RADPS, motion.angular_velocity.length()),
                (Cause::BelowGround, MAX_DEPTH_M, state.ground_height - motion.position.z),
                (Cause::TooFarAway, MAX_DISTANCE_M, motion.position.length()),
            ];
            let bad = sizes.into_iter().find(|&(_, limit, found)| found.is_nan() || found > limit);
            if let Some((cause, limit, found)) = bad {
                let cause = if found.is_finite() { cause } else { Cause::NotFinite };
                return Err(Self { tick, cause, body: body.name.clone(), limit, found });
            }
        }
        Ok(())
    }
}
