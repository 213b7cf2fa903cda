//! Props of a world: what characters kick, open and carry along.

use policy_core::contract::{MAX_DEPTH_M, MAX_DISTANCE_M, MAX_SPEED_MPS, Motion, Prop, Solid};
use policy_core::glam::Vec3;
use rapier3d::dynamics::{CoefficientCombineRule, RigidBodyBuilder, RigidBodyHandle};
use rapier3d::math::Pose;

use super::shape::{of_solid, rough};
use super::{MOST, PropBody, World, WorldError};

impl World {
    /// Adds a prop and returns its index. Allocates.
    ///
    /// # Errors
    /// When a number of it or of its motion is out of its range, or the world has as many props as it may have.
    pub fn add_prop(&mut self, prop: &Prop, motion: &Motion) -> Result<usize, WorldError> {
        prop.check()?;
        motion.check()?;
        if self.props.len() >= MOST {
            return Err(WorldError::Full { what: "props", most: MOST });
        }
        let start = Pose::from_parts(motion.position, motion.rotation);
        let collider = rough(of_solid(&prop.solid)?, prop.friction)
            .mass(prop.mass_kg)
            .restitution(prop.bounce)
            .restitution_combine_rule(CoefficientCombineRule::Max);
        // A prop that slept would wake at other ticks after a restore than before it.
        let body = RigidBodyBuilder::dynamic()
            .pose(start)
            .linvel(motion.velocity)
            .angvel(motion.spin)
            .can_sleep(false);
        let around = collider.shape.compute_local_bounding_sphere();
        let reach = around.center().length() + around.radius();
        let world = &mut self.world;
        let body = world.bodies.insert(body);
        world.colliders.insert_with_parent(collider, body, &mut world.bodies);
        self.props.push(PropBody { body, solid: prop.solid.clone(), start, reach });
        Ok(self.props.len() - 1)
    }

    /// Props in it.
    #[must_use]
    pub fn prop_count(&self) -> usize {
        self.props.len()
    }

    /// Shape of a prop, and how it moves; `None` when there is no such prop.
    #[must_use]
    pub fn prop(&self, index: usize) -> Option<(&Solid, Motion)> {
        let prop = self.props.get(index)?;
        let body = &self.world.bodies[prop.body];
        let Pose { translation: position, rotation, .. } = *body.position();
        Some((&prop.solid, Motion { position, rotation, velocity: body.linvel(), spin: body.angvel() }))
    }

    /// Pushes a prop at its centre: as much as a force would over a tick. Newtons, world space.
    ///
    /// # Errors
    /// When there is no such prop, or the force is not finite.
    pub fn push_prop(&mut self, index: usize, force: Vec3) -> Result<(), WorldError> {
        let body = self.prop_body(index)?;
        if !force.is_finite() {
            return Err(WorldError::Force { found: force });
        }
        let secs = 1.0 / self.model.control_hz();
        self.world.bodies[body].apply_impulse(force * secs, true);
        Ok(())
    }

    pub(super) fn prop_body(&self, index: usize) -> Result<RigidBodyHandle, WorldError> {
        let found = self.props.len();
        let prop = self.props.get(index);
        prop.map(|prop| prop.body).ok_or(WorldError::Missing { what: "prop", index, found })
    }

    /// Puts every prop that moves implausibly back to where it began, at rest. Returns how many.
    pub fn reset_lost_props(&mut self) -> usize {
        let mut reset = 0;
        for prop in &self.props {
            let body = &mut self.world.bodies[prop.body];
            let (at, velocity) = (body.translation(), body.linvel());
            let sound = at.is_finite()
                && velocity.is_finite()
                && body.angvel().is_finite()
                && at.length() <= MAX_DISTANCE_M
                && at.z >= self.model.height_at(at.x, at.y) - MAX_DEPTH_M
                && velocity.length() <= MAX_SPEED_MPS;
            if !sound {
                body.set_position(prop.start, true);
                body.set_linvel(Vec3::ZERO, true);
                body.set_angvel(Vec3::ZERO, true);
                reset += 1;
            }
        }
        reset
    }
}
