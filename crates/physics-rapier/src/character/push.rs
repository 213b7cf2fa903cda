//! Pushes from outside: a force on a body for a while, or an impulse.
//!
//! Both become forces. Rapier loses an impulse on a link of a multibody.

use policy_core::contract::{MAX_PUSHED_MPS, PushError, check_impulse, check_push};
use policy_core::glam::Vec3;
use policy_core::{BodyId, BodyState, CharacterState, Skeleton};
use rapier3d::dynamics::{RigidBody, RigidBodyHandle, RigidBodySet};

use super::Character;

/// The pushes under way, one entry for each body. World axes, at the centre of mass of each body.
#[derive(Clone)]
pub(crate) struct Pushes {
    /// Newtons.
    forces: Vec<Vec3>,
    /// How much longer each force acts, physics steps.
    steps_left: Vec<u32>,
    /// Newton seconds, for the next physics step.
    impulses: Vec<Vec3>,
}

impl Pushes {
    /// No push. Allocates.
    pub(crate) fn new(skeleton: &Skeleton) -> Self {
        let count = skeleton.body_count();
        Self {
            forces: vec![Vec3::ZERO; count],
            steps_left: vec![0; count],
            impulses: vec![Vec3::ZERO; count],
        }
    }

    /// Ends every push.
    pub(crate) fn clear(&mut self) {
        self.steps_left.fill(0);
        self.impulses.fill(Vec3::ZERO);
    }

    pub(crate) fn acts_on(&self, body: BodyId) -> bool {
        let index = body.index();
        self.steps_left.get(index).is_some_and(|&left| left > 0)
            || self.impulses.get(index).is_some_and(|&impulse| impulse != Vec3::ZERO)
    }

    /// Begins a push of so many seconds, in place of the one that still acts on the body.
    ///
    /// # Errors
    /// As [`Character::push`].
    pub(crate) fn push(
        &mut self,
        body: BodyId,
        force: Vec3,
        secs: f32,
        dt_secs: f32,
    ) -> Result<(), PushError> {
        check_push(body, self.forces.len(), force, secs)?;
        self.forces[body.index()] = force;
        self.steps_left[body.index()] = (secs / dt_secs).round() as u32;
        Ok(())
    }

    /// Writes what is under way, for a hash of the state.
    pub(crate) fn bits(&self, out: &mut impl FnMut(u32)) {
        for ((force, &steps), impulse) in self.forces.iter().zip(&self.steps_left).zip(&self.impulses) {
            if steps > 0 || *impulse != Vec3::ZERO {
                out(steps);
                force.to_array().into_iter().chain(impulse.to_array()).for_each(|v| out(v.to_bits()));
            }
        }
    }

    /// True while a force has to be added.
    pub(crate) fn are_under_way(&self) -> bool {
        self.steps_left.iter().any(|&left| left > 0) || self.impulses.iter().any(|&i| i != Vec3::ZERO)
    }

    /// Adds the forces of the physics step that comes next, but for bodies that outrun theirs. `state` is that of now.
    pub(crate) fn apply(
        &mut self,
        bodies: &mut RigidBodySet,
        handles: &[RigidBodyHandle],
        state: &CharacterState,
        dt_secs: f32,
    ) {
        for (index, &handle) in handles.iter().enumerate() {
            let mut force = std::mem::take(&mut self.impulses[index]) / dt_secs;
            if self.steps_left[index] > 0 {
                self.steps_left[index] -= 1;
                force += self.forces[index];
            }
            if force != Vec3::ZERO && !outruns(&bodies[handle], &state.bodies[index], force) {
                bodies[handle].add_force(force, true);
            }
        }
    }
}

/// True when the centre of mass of a body moves along `force` faster than a push can drive it.
fn outruns(body: &RigidBody, state: &BodyState, force: Vec3) -> bool {
    let centre = *body.position() * body.mass_properties().local_mprops.local_com;
    let velocity = state.linear_velocity + state.angular_velocity.cross(centre - state.position);
    velocity.dot(force) > MAX_PUSHED_MPS * force.length()
}

impl Character {
    /// Pushes `body` at its centre of mass with `force` newtons, world axes, for `secs` from now, rounded to whole
    /// physics steps. Replaces the push that still acts on the body. Posing the character ends it.
    ///
    /// While the body already moves along the force at [`MAX_PUSHED_MPS`], the force is zero, so pushes that are repeated
    /// do not add up without bound.
    ///
    /// # Errors
    /// When there is no such body, a number is not finite, the force is over 1 MN, or the duration negative or over
    /// an hour.
    pub fn push(&mut self, body: BodyId, force: Vec3, secs: f32) -> Result<(), PushError> {
        self.pushes.push(body, force, secs, self.world.integration_parameters.dt)
    }

    /// Hits `body` at its centre of mass with `impulse` newton seconds, world axes, during the next physics step.
    /// Several impulses before it add up. An impulse on a body that already moves along it at [`MAX_PUSHED_MPS`] has no
    /// effect.
    ///
    /// # Errors
    /// When there is no such body, or the impulse is not finite or over 1 MN s.
    pub fn impulse(&mut self, body: BodyId, impulse: Vec3) -> Result<(), PushError> {
        let sum = self.pushes.impulses.get(body.index()).copied().unwrap_or_default() + impulse;
        check_impulse(body, self.pushes.impulses.len(), sum)?;
        self.pushes.impulses[body.index()] = sum;
        Ok(())
    }
}
