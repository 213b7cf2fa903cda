//! Limits of plausible motion, checked at the end of each control tick. MuJoCo itself stops only at numbers
//! that are not finite or above 1e10; a simulation has diverged long before that.

use glam::DVec3;
use policy_core::BodyId;
use policy_core::contract::{MAX_DEPTH_M, MAX_DISTANCE_M, MAX_SPEED_MPS, MAX_SPIN_RADPS};

use super::sense::{velocity_at, velocity_reference};
use super::{Cause, Character, Excess};

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
