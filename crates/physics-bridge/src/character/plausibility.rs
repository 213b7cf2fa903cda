//! Limits of plausible motion, checked at the end of each control tick.

use glam::DVec3;
use policy_core::BodyId;

use super::Character;
use crate::cause::{Cause, Excess};
use crate::kinematics::{fault, velocity_at, velocity_reference};

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
            let motion = velocity_at(cvel[id], position - reference);
            let ground = self.model.height_at(position.x as f32, position.y as f32);
            let (cause, excess) = fault(position, motion, ground)?;
            Some(Fault { cause, body: BodyId::new(index), excess })
        })
    }
}
