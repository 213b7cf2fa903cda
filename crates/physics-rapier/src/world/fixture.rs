//! Things that never move, and how high the ground is that they and the model make.

use policy_core::contract::Fixture;
use policy_core::glam::Vec3;
use rapier3d::geometry::{Aabb, ColliderHandle};
use rapier3d::parry::query::Ray;

use super::shape::of_fixture;
use super::{MOST, PropBody, World, WorldError};

/// Ground further below a point than this does not count, metres.
const FARTHEST_M: f32 = 100.0;

/// A fixture in the world. It stays where it is, and so does its box.
#[derive(Clone, Copy, Debug)]
pub(super) struct Standing {
    collider: ColliderHandle,
    around: Aabb,
}

impl World {
    /// Adds something that never moves. Allocates.
    ///
    /// # Errors
    /// When a number of it is out of its range, or the world has as many fixtures as it may have.
    pub fn add_fixture(&mut self, fixture: &Fixture) -> Result<(), WorldError> {
        fixture.check()?;
        if self.fixtures.len() >= MOST {
            return Err(WorldError::Full { what: "fixtures", most: MOST });
        }
        let collider = of_fixture(fixture)?.build();
        let around = collider.compute_aabb();
        let collider = self.world.colliders.insert(collider);
        self.fixtures.push(Standing { collider, around });
        Ok(())
    }

    /// Fixtures in it.
    #[must_use]
    pub fn fixture_count(&self) -> usize {
        self.fixtures.len()
    }

    /// Height of the highest fixture below a point, or of the model's ground if that is higher. Metres, world space.
    #[must_use]
    pub fn ground_below(&self, point: Vec3) -> f32 {
        let ground = self.model.height_at(point.x, point.y);
        let ray = Ray::new(point, Vec3::NEG_Z);
        let under = |standing: &&Standing| {
            let (low, high) = (standing.around.mins, standing.around.maxs);
            (low.x..=high.x).contains(&point.x) && (low.y..=high.y).contains(&point.y) && low.z <= point.z
        };
        let heights = self.fixtures.iter().filter(under).filter_map(|standing| {
            let collider = &self.world.colliders[standing.collider];
            let distance = collider.shape().cast_ray(collider.position(), &ray, FARTHEST_M, true)?;
            Some(point.z - distance)
        });
        heights.fold(ground, f32::max)
    }

    /// Height of the ground below a point, or of the highest prop below it that reaches no higher than `top`: what a character can step onto.
    pub(super) fn footing_below(&self, point: Vec3, top: f32) -> f32 {
        let ray = Ray::new(Vec3::new(point.x, point.y, top), Vec3::NEG_Z);
        let near = |prop: &&PropBody| {
            let off = self.world.bodies[prop.body].translation() - ray.origin;
            off.truncate().length_squared() <= prop.reach * prop.reach && off.z <= prop.reach
        };
        let colliders =
            self.props.iter().filter(near).flat_map(|prop| self.world.bodies[prop.body].colliders());
        let heights = colliders.filter_map(|&collider| {
            let collider = &self.world.colliders[collider];
            let distance = collider.shape().cast_ray(collider.position(), &ray, FARTHEST_M, true)?;
            // A ray that begins inside of a prop meets it at once: that one is higher.
            (distance > 0.0).then_some(top - distance)
        });
        heights.fold(self.ground_below(point), f32::max)
    }
}
