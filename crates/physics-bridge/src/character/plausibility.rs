//! Limits of plausible motion, checked at the end of each control tick. MuJoCo itself stops only at numbers
//! that are not finite or above 1e10; a simulation has diverged long before that.

use glam::DVec3;
use policy_core::BodyId;

use super::sense::{velocity_at, velocity_reference};
use super::{Cause, Character, Excess};

/// Largest plausible speed of a body, metres per second.
pub const MAX_SPEED_MPS: f32 = 50.0;

/// Largest plausible angular speed of a body, radians per second. Motors of normal strength that are driven at
/// random spin a foot at 35 rad/s.
pub const MAX_SPIN_RADPS: f32 = 200.0;

/// How deep the origin of a body may be below the ground, metres. Generous, because an edge of a steep step
/// may be inside a foot.
pub const MAX_DEPTH_M: f32 = 0.5;

/// How far a body may be from the origin of the world, metres. Further away, single precision resolves a
/// position to a millimetre only.
pub const MAX_DISTANCE_M: f32 = 10_000.0;

/// A body that does what no body can.
pub(super) struct Fault {
    pub cause: Cause,
    pub body: BodyId,
    pub excess: Excess,
}

impl Character {
    /// The first body with a fault, and its first fault in the order of [`Cause`]. Everything derived from the
    /// state must be up to date.
    pub(super) fn fault(&self) -> Option<Fault> {
        let (xpos, cvel) = (self.data.xpos(), self.data.cvel());
        let layout = self.model.layout();
        let reference = velocity_reference(&self.data, layout);
        layout.body_ids.iter().enumerate().find_map(|(index, &id)| {
            let position = DVec3::from(xpos[id]);
            let (angular, linear) = velocity_at(cvel[id], position - reference);
            let ground = self.model.height_at(position.x as f32, position.y as f32);
            let checks = [
                (Cause::SpinsTooFast, angular.length(), MAX_SPIN_RADPS),
                (Cause::TooFast, linear.length(), MAX_SPEED_MPS),
                (Cause::BelowGround, f64::from(ground) - position.z, MAX_DEPTH_M),
                (Cause::TooFarAway, position.length(), MAX_DISTANCE_M),
            ];
            // MuJoCo has checked that the numbers are finite.
            let (cause, value, limit) = checks.into_iter().find(|&(_, value, limit)| value > limit.into())?;
            let body = BodyId::new(index);
            Some(Fault { cause, body, excess: Excess { value: value as f32, limit } })
        })
    }
}
