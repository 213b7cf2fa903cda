//! Pushes from outside: a force on a body for a while, or an impulse.

use glam::{DVec3, Vec3};
use mujoco_rs::wrappers::mj_data::MjData;
use mujoco_rs::wrappers::mj_model::MjModel;
use policy_core::{BODY_COUNT, Body};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

use crate::character::Character;
use crate::layout::Layout;
use crate::sense::velocity_at;

/// Why a push is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PushError {
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

/// Largest force, newtons, and largest impulse, newton seconds.
const MOST_FORCE: f32 = 1e6;

/// Speed to which pushes drive a body, metres per second.
pub const MAX_PUSHED_MPS: f32 = 20.0;

/// Longest push, seconds.
const MOST_SECS: f32 = 3600.0;

/// The pushes under way. World axes, at the centre of mass of each body.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Pushes {
    /// Newtons.
    forces: [[f32; 3]; BODY_COUNT],
    /// How much longer each force acts.
    substeps_left: [u32; BODY_COUNT],
    /// Newton seconds, for the next substep.
    impulses: [[f32; 3]; BODY_COUNT],
    /// True while anything above is to be written to MuJoCo, or to be taken back from it.
    under_way: bool,
}

impl Pushes {
    /// Writes the forces of the substep that comes next. Velocities in `data` must be up to date.
    pub(crate) fn apply(&mut self, data: &mut MjData<Arc<MjModel>>, layout: &Layout) {
        if !self.under_way {
            return;
        }
        self.under_way = false;
        let timestep = data.model_opt().timestep;
        for (index, &id) in layout.body_ids.iter().enumerate() {
            let mut force = Vec3::from(self.impulses[index]).as_dvec3() / timestep;
            if self.substeps_left[index] > 0 {
                self.substeps_left[index] -= 1;
                force += Vec3::from(self.forces[index]).as_dvec3();
            }
            self.impulses[index] = [0.0; 3];
            // One more substep after the last one, to write zeros.
            self.under_way |= force.length_squared() > 0.0 || self.substeps_left[index] > 0;
            if outruns(data, layout, id, force) {
                force = DVec3::ZERO;
            }
            data.xfrc_applied_mut()[id][..3].copy_from_slice(&force.to_array());
        }
    }

    /// True when every number is one that [`Character::push`] and [`Character::impulse`] accept.
    pub(crate) fn are_sound(&self) -> bool {
        let sound = |v: &[f32; 3]| Vec3::from(*v).length() <= MOST_FORCE;
        self.forces.iter().all(sound) && self.impulses.iter().all(sound)
    }
}

impl Character {
    /// Pushes `body` at its centre of mass with `force` newtons, world axes, for `secs` from now, rounded to
    /// whole substeps. Replaces the push that still acts on the body. Posing the character ends it.
    ///
    /// While the body already moves along the force at [`MAX_PUSHED_MPS`], the force is zero, so pushes that
    /// are repeated do not add up without bound.
    ///
    /// # Errors
    /// When a number is not finite, the force is over 1 MN, or the duration negative or over an hour.
    pub fn push(&mut self, body: Body, force: Vec3, secs: f32) -> Result<(), PushError> {
        at_most("a force", force.length(), MOST_FORCE)?;
        at_most("a duration", secs, MOST_SECS)?;
        let substeps = (f64::from(secs) / self.model.timestep_secs()).round();
        self.pushes.forces[body.index()] = force.to_array();
        self.pushes.substeps_left[body.index()] = substeps as u32;
        self.pushes.under_way = true;
        Ok(())
    }

    /// True while a push acts on `body`, or an impulse waits for the next substep.
    #[must_use]
    pub fn is_pushed(&self, body: Body) -> bool {
        let index = body.index();
        self.pushes.substeps_left[index] > 0 || self.pushes.impulses[index] != [0.0; 3]
    }

    /// Hits `body` at its centre of mass with `impulse` newton seconds, world axes, during the next substep.
    /// Several impulses before it add up. An impulse on a body that already moves along it at
    /// [`MAX_PUSHED_MPS`] has no effect.
    ///
    /// # Errors
    /// When the impulse is not finite or over 1 MN s.
    pub fn impulse(&mut self, body: Body, impulse: Vec3) -> Result<(), PushError> {
        let sum = Vec3::from(self.pushes.impulses[body.index()]) + impulse;
        at_most("an impulse", sum.length(), MOST_FORCE)?;
        self.pushes.impulses[body.index()] = sum.to_array();
        self.pushes.under_way = true;
        Ok(())
    }
}

/// True when the centre of mass of a body moves along `force` faster than a push can drive it.
fn outruns(data: &MjData<Arc<MjModel>>, layout: &Layout, id: usize, force: DVec3) -> bool {
    let reference = DVec3::from(data.subtree_com()[layout.body_ids[0]]);
    let (_, velocity) = velocity_at(data.cvel()[id], DVec3::from(data.xipos()[id]) - reference);
    velocity.dot(force) > f64::from(MAX_PUSHED_MPS) * force.length()
}

fn at_most(what: &'static str, found: f32, most: f32) -> Result<(), PushError> {
    if (0.0..=most).contains(&found) { Ok(()) } else { Err(PushError::Size { what, most, found }) }
}
