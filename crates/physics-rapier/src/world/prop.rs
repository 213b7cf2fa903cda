//! Props of a world: boxes and balls that characters kick and carry along.

use policy_core::contract::{MAX_DEPTH_M, MAX_DISTANCE_M, MAX_SPEED_MPS};
use policy_core::glam::{Quat, Vec3};
use rapier3d::dynamics::RigidBodyBuilder;
use rapier3d::geometry::ColliderBuilder;
use rapier3d::math::Pose;

use super::{MOST, Prop, World, WorldError};

/// Smallest and largest half extent or radius, metres.
const SIZES_M: std::ops::RangeInclusive<f32> = 0.01..=50.0;
/// Least and most mass, kilograms.
const MASSES_KG: std::ops::RangeInclusive<f32> = 0.01..=10_000.0;
/// Friction of props.
const FRICTION: f32 = 0.6;

/// Shape of a prop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PropShape {
    /// A box.
    Box {
        /// Half its lengths along x, y and z, metres.
        half_extents: [f32; 3],
    },
    /// A ball.
    Ball {
        /// Metres.
        radius: f32,
    },
}

impl World {
    /// Adds a prop at rest with its centre at a point, metres, and returns its index. Allocates.
    ///
    /// # Errors
    /// When a length is not in [0.01, 50] m, the mass not in [0.01, 10,000] kg, the point not finite, or the world has as
    /// many props as it may have.
    pub fn add_prop(&mut self, shape: PropShape, mass_kg: f32, at: Vec3) -> Result<usize, WorldError> {
        if self.props.len() >= MOST {
            return Err(WorldError::Full { what: "props", most: MOST });
        }
        let within = |expected, found: f32, holds: bool| {
            if holds { Ok(()) } else { Err(WorldError::Prop { expected, found }) }
        };
        within("a mass of 0.01 to 10000 kg", mass_kg, MASSES_KG.contains(&mass_kg))?;
        let far = at.abs().max_element();
        within("a place within 1000 m of the origin", far, at.is_finite() && far <= 1000.0)?;
        let size = "lengths of 0.01 to 50 m";
        let collider = match shape {
            PropShape::Box { half_extents } => {
                for half in half_extents {
                    within(size, half, SIZES_M.contains(&half))?;
                }
                let [x, y, z] = half_extents;
                ColliderBuilder::cuboid(x, y, z)
            }
            PropShape::Ball { radius } => {
                within(size, radius, SIZES_M.contains(&radius))?;
                ColliderBuilder::ball(radius)
            }
        };
        let world = &mut self.world;
        // A prop that slept would wake at other ticks after a restore than before it.
        let body = world.bodies.insert(RigidBodyBuilder::dynamic().translation(at).can_sleep(false));
        let collider = collider.mass(mass_kg).friction(FRICTION);
        world.colliders.insert_with_parent(collider, body, &mut world.bodies);
        self.props.push(Prop { body, shape, start: at });
        Ok(self.props.len() - 1)
    }

    /// Props in it.
    #[must_use]
    pub fn prop_count(&self) -> usize {
        self.props.len()
    }

    /// Shape, centre in metres and rotation of a prop; `None` when there is no such prop.
    #[must_use]
    pub fn prop(&self, index: usize) -> Option<(PropShape, Vec3, Quat)> {
        let prop = self.props.get(index)?;
        let pose = self.world.bodies[prop.body].position();
        Some((prop.shape, pose.translation, pose.rotation))
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
                && at.z >= -MAX_DEPTH_M
                && velocity.length() <= MAX_SPEED_MPS;
            if !sound {
                body.set_position(Pose::from_translation(prop.start), true);
                body.set_linvel(Vec3::ZERO, true);
                body.set_angvel(Vec3::ZERO, true);
                reset += 1;
            }
        }
        reset
    }
}
