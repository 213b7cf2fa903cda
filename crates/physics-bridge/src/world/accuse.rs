//! Finds what diverged: numbers that are not finite or huge, and bodies beyond the limits of plausible motion.

use mujoco_rs::wrappers::mj_data::MjtWarning;

use super::World;
use super::forces::reference;
use super::places::Owner;
use super::recover::{Divergence, Remedy};
use super::solids::vec3;
use crate::cause::{Cause, Excess};
use crate::kinematics::{fault, velocity_at};

/// Numbers beyond this, MuJoCo calls bad.
const HUGE: f64 = 1e10;

/// Something found wrong in a tick. A prop is named by what its tree hangs on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Culprit {
    pub owner: Owner,
    pub cause: Cause,
    pub excess: Option<Excess>,
}

/// Not finite, or huge.
pub(super) fn is_bad(number: &f64) -> bool {
    number.is_nan() || number.abs() > HUGE
}

impl Culprit {
    /// How many times the limit; without bound for what has no limit.
    pub(super) fn severity(&self) -> f32 {
        self.excess.map_or(f32::MAX, |excess| excess.value / excess.limit)
    }
}

impl World {
    /// Notes that something is wrong with a body, once for each character and each tree of props.
    fn accuse(&mut self, body: usize, cause: Cause, excess: Option<Excess>) {
        let owner = match self.places.owners[body] {
            Owner::Prop(prop) => Owner::Prop(self.scene.root_of(prop)),
            Owner::Character(index, _) => Owner::Character(index, policy_core::BodyId::new(0)),
            owner => owner,
        };
        if !self.culprits.iter().any(|culprit| culprit.owner == owner) && self.is_present(owner) {
            self.culprits.push(Culprit { owner, cause, excess });
        }
    }

    /// Finds every tree with numbers that are not finite or huge, if MuJoCo has warned of any. True when there is one.
    pub(super) fn accuse_warned(&mut self) -> bool {
        let quiet = self.data.warning().iter().all(|warning| warning.number == 0);
        if quiet && !self.data.qpos().iter().chain(self.data.qvel()).any(is_bad) {
            return false;
        }
        for index in 0..self.data.qpos().len() {
            if is_bad(&self.data.qpos()[index]) {
                self.accuse(self.places.qpos_bodies[index], Cause::BadPosition, None);
            }
        }
        for index in 0..self.data.qvel().len() {
            let body = self.data.model().dof_bodyid()[index] as usize;
            if is_bad(&self.data.qvel()[index]) {
                self.accuse(body, Cause::BadVelocity, None);
            } else if is_bad(&self.data.qacc()[index]) {
                self.accuse(body, Cause::BadAcceleration, None);
            }
        }
        let singular = &self.data.warning()[MjtWarning::mjWARN_INERTIA as usize];
        if let (1.., Ok(dof)) = (singular.number, usize::try_from(singular.lastinfo)) {
            let body = self.data.model().dof_bodyid().get(dof).map_or(0, |&body| body as usize);
            self.accuse(body, Cause::SingularInertia, None);
        }
        for (cause, warning) in Cause::WARNINGS.into_iter().zip(self.data.warning()) {
            let full = matches!(cause, Cause::ContactsFull | Cause::ConstraintsFull);
            let told = |d: &Divergence| d.cause == cause;
            if full && warning.number > 0 && !self.divergences.iter().any(told) {
                self.divergences.push(Divergence { what: None, cause, excess: None, remedy: Remedy::None });
            }
        }
        if self.culprits.is_empty() {
            self.clear_warnings();
        }
        !self.culprits.is_empty()
    }

    /// Finds every tree with a body beyond the limits of plausible motion. True when there is one. Everything derived
    /// from the state must be up to date.
    pub(super) fn accuse_implausible(&mut self) -> bool {
        for body in 1..self.places.owners.len() {
            if matches!(self.places.owners[body], Owner::Ground | Owner::Fixture(_)) {
                continue;
            }
            let position = vec3(self.data.xpos()[body]);
            let motion = velocity_at(self.data.cvel()[body], position - reference(&self.data, body));
            let ground = self.ground.height_at(position.x as f32, position.y as f32);
            if let Some((cause, excess)) = fault(position, motion, ground) {
                self.accuse(body, cause, Some(excess));
            }
        }
        !self.culprits.is_empty()
    }

    pub(super) fn is_present(&self, owner: Owner) -> bool {
        match owner {
            Owner::Prop(index) => self.scene.props.slot(index).is_some_and(|slot| slot.present),
            Owner::Character(index, _) => self.scene.characters.slot(index).is_some_and(|slot| slot.present),
            Owner::Ground | Owner::Fixture(_) => false,
        }
    }

    /// Clears MuJoCo's counters.
    pub(super) fn clear_warnings(&mut self) {
        self.data.warning_mut().iter_mut().for_each(|warning| warning.number = 0);
    }
}
