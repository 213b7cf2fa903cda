//! Pushes from outside: a force on a body for a while, or an impulse.

use glam::{DVec3, Vec3};
use mujoco_rs::wrappers::mj_data::MjData;
use mujoco_rs::wrappers::mj_model::MjModel;
use policy_core::contract::{
    MAX_FORCE_N, MAX_IMPULSE_NS, MAX_PUSHED_MPS, PushError, check_impulse, check_push,
};
use policy_core::{BodyId, Skeleton};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

use super::Character;
use crate::description::layout::Layout;
use crate::kinematics::{velocity_at, velocity_reference};

/// The pushes under way, one entry for each body. World axes, at the centre of mass of each body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Pushes {
    /// Newtons.
    forces: Vec<[f32; 3]>,
    /// How much longer each force acts.
    substeps_left: Vec<u32>,
    /// Newton seconds, for the next substep.
    impulses: Vec<[f32; 3]>,
    /// True while a force has to be written to MuJoCo, or a zero after the last one.
    under_way: bool,
}

impl Pushes {
    /// No push. Allocates.
    pub(super) fn new(skeleton: &Skeleton) -> Self {
        let count = skeleton.body_count();
        Self {
            forces: vec![[0.0; 3]; count],
            substeps_left: vec![0; count],
            impulses: vec![[0.0; 3]; count],
            under_way: false,
        }
    }

    /// Ends every push.
    pub(super) fn clear(&mut self) {
        self.forces.fill([0.0; 3]);
        self.substeps_left.fill(0);
        self.impulses.fill([0.0; 3]);
        self.under_way = false;
    }

    /// Overwrites this with pushes on as many bodies. Does not allocate.
    pub(super) fn copy_from(&mut self, other: &Self) {
        self.forces.copy_from_slice(&other.forces);
        self.substeps_left.copy_from_slice(&other.substeps_left);
        self.impulses.copy_from_slice(&other.impulses);
        self.under_way = other.under_way;
    }

    /// Number of bodies.
    pub(super) fn len(&self) -> usize {
        self.forces.len()
    }

    /// True when there is an entry for each of so many bodies.
    pub(super) fn fit(&self, bodies: usize) -> bool {
        [self.forces.len(), self.substeps_left.len(), self.impulses.len()] == [bodies; 3]
    }

    /// Writes the forces of the substep that comes next. Velocities in `data` must be up to date.
    pub(super) fn apply(&mut self, data: &mut MjData<Arc<MjModel>>, layout: &Layout) {
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
    pub(super) fn are_sound(&self) -> bool {
        let within = |all: &[[f32; 3]], most| all.iter().all(|v| Vec3::from(*v).length() <= most);
        within(&self.forces, MAX_FORCE_N) && within(&self.impulses, MAX_IMPULSE_NS)
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
    /// When there is no such body, a number is not finite, the force is over 1 MN, or the duration negative or
    /// over an hour.
    pub fn push(&mut self, body: BodyId, force: Vec3, secs: f32) -> Result<(), PushError> {
        check_push(body, self.pushes.len(), force, secs)?;
        let substeps = (f64::from(secs) / self.model.timestep_secs()).round();
        self.pushes.forces[body.index()] = force.to_array();
        self.pushes.substeps_left[body.index()] = substeps as u32;
        self.pushes.under_way = true;
        Ok(())
    }

    /// True while a push acts on `body`, or an impulse waits for the next substep.
    #[must_use]
    pub fn is_pushed(&self, body: BodyId) -> bool {
        let index = body.index();
        let left = self.pushes.substeps_left.get(index);
        left.is_some_and(|&left| left > 0) || self.pushes.impulses.get(index).is_some_and(|i| *i != [0.0; 3])
    }

    /// Hits `body` at its centre of mass with `impulse` newton seconds, world axes, during the next substep.
    /// Several impulses before it add up. An impulse on a body that already moves along it at
    /// [`MAX_PUSHED_MPS`] has no effect.
    ///
    /// # Errors
    /// When there is no such body, or the impulse is not finite or over 1 MN s.
    pub fn impulse(&mut self, body: BodyId, impulse: Vec3) -> Result<(), PushError> {
        let waiting = self.pushes.impulses.get(body.index()).copied().unwrap_or_default();
        let sum = Vec3::from(waiting) + impulse;
        check_impulse(body, self.pushes.len(), sum)?;
        self.pushes.impulses[body.index()] = sum.to_array();
        self.pushes.under_way = true;
        Ok(())
    }
}

/// True when the centre of mass of a body moves along `force` faster than a push can drive it.
fn outruns(data: &MjData<Arc<MjModel>>, layout: &Layout, id: usize, force: DVec3) -> bool {
    let reference = velocity_reference(data, layout);
    let (_, velocity) = velocity_at(data.cvel()[id], DVec3::from(data.xipos()[id]) - reference);
    velocity.dot(force) > f64::from(MAX_PUSHED_MPS) * force.length()
}
