//! Pushes from outside: what a body takes, and how fast they drive it.

use glam::Vec3;

use crate::ids::BodyId;

/// Why a push is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PushError {
    /// The character has no such body.
    #[error("expected one of {bodies} bodies, found index {found}")]
    Body {
        /// Bodies of the character.
        bodies: usize,
        /// Index of the body.
        found: usize,
    },
    /// A number is not finite, or too large to mean anything.
    #[error("expected {what} of at most {most} in size, found {found}")]
    Size {
        /// `a force` in newtons, `an impulse` in newton seconds or `a duration` in seconds.
        what: &'static str,
        /// The limit.
        most: f32,
        /// Its size.
        found: f32,
    },
}

/// Largest force, newtons.
pub const MAX_FORCE_N: f32 = 1e6;

/// Largest impulse, newton seconds.
pub const MAX_IMPULSE_NS: f32 = 1e6;

/// Longest push, seconds.
pub const MAX_PUSH_SECS: f32 = 3600.0;

/// Speed to which pushes drive a body, metres per second.
pub const MAX_PUSHED_MPS: f32 = 20.0;

/// Checks a force in newtons for some seconds, on a body of a character that has so many.
///
/// # Errors
/// When there is no such body, a number is not finite, the force is over [`MAX_FORCE_N`], or the duration negative or
/// over [`MAX_PUSH_SECS`].
pub fn check_push(body: BodyId, bodies: usize, force: Vec3, secs: f32) -> Result<(), PushError> {
    check_body(body, bodies)?;
    at_most("a force", force.length(), MAX_FORCE_N)?;
    at_most("a duration", secs, MAX_PUSH_SECS)
}

/// Checks the impulses of one physics step together, in newton seconds, on a body of a character that has so many.
///
/// # Errors
/// When there is no such body, or the impulse is not finite or over [`MAX_IMPULSE_NS`].
pub fn check_impulse(body: BodyId, bodies: usize, impulse: Vec3) -> Result<(), PushError> {
    check_body(body, bodies)?;
    at_most("an impulse", impulse.length(), MAX_IMPULSE_NS)
}

fn check_body(body: BodyId, bodies: usize) -> Result<(), PushError> {
    let found = body.index();
    if found < bodies { Ok(()) } else { Err(PushError::Body { bodies, found }) }
}

fn at_most(what: &'static str, found: f32, most: f32) -> Result<(), PushError> {
    if (0.0..=most).contains(&found) { Ok(()) } else { Err(PushError::Size { what, most, found }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pushes_out_of_bounds_are_refused() {
        let body = BodyId::new(2);
        assert_eq!(check_push(body, 3, Vec3::splat(100.0), 0.2), Ok(()));
        assert_eq!(check_push(body, 2, Vec3::X, 0.2), Err(PushError::Body { bodies: 2, found: 2 }));
        for (force, secs) in [(2e6, 0.2), (f32::NAN, 0.2), (1.0, -0.1), (1.0, f32::NAN), (1.0, 4000.0)] {
            let error = check_push(body, 3, force * Vec3::X, secs);
            assert!(matches!(error, Err(PushError::Size { .. })), "{force} {secs}: {error:?}");
        }
        assert_eq!(check_impulse(body, 3, Vec3::NEG_Z), Ok(()));
        assert!(check_impulse(body, 3, 2e6 * Vec3::Y).is_err() && check_impulse(body, 1, Vec3::Y).is_err());
    }
}
