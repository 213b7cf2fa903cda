//! Things that move in a world, and convex bodies. Every number has a range.

use std::sync::Arc;

use glam::{Quat, Vec3};
use policy_core::contract::{MAX_DISTANCE_M, MAX_SPEED_MPS, MAX_SPIN_RADPS};

use super::world_error::{WorldError, within};

/// Range of a radius, a half length or half a side, metres.
pub const SIZE_RANGE_M: [f32; 2] = [0.005, 100.0];

/// Range of the mass of a prop, kilograms.
pub const MASS_RANGE_KG: [f32; 2] = [0.01, 10_000.0];

/// Range of a friction coefficient.
pub const FRICTION_RANGE: [f32; 2] = [0.0, 5.0];

/// Most corners of a hull.
pub const MAX_HULL_POINTS: usize = 256;

/// Least thickness of a hull, metres.
const LEAST_THICKNESS_M: f32 = 0.002;

/// A convex body, in its own frame. Sizes are metres, in [`SIZE_RANGE_M`].
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Solid {
    /// A ball.
    Sphere {
        /// Its radius.
        radius: f32,
    },
    /// A cylinder along z with round ends.
    Capsule {
        /// Its radius.
        radius: f32,
        /// Half its length between the centres of the ends.
        half_length: f32,
    },
    /// A cylinder along z.
    Cylinder {
        /// Its radius.
        radius: f32,
        /// Half its length.
        half_length: f32,
    },
    /// A cuboid.
    Cuboid {
        /// Half its sides.
        half_extents: Vec3,
    },
    /// The convex hull of points.
    Hull {
        /// Its corners, 4 to [`MAX_HULL_POINTS`], not in one plane.
        points: Arc<[Vec3]>,
    },
}

/// Something that moves: a crate, a ball, a door.
#[derive(Clone, Debug, PartialEq)]
pub struct Prop {
    /// Its shape. The origin of its frame is that of the shape.
    pub solid: Solid,
    /// Kilograms, in [`MASS_RANGE_KG`].
    pub mass_kg: f32,
    /// Sliding friction, in [`FRICTION_RANGE`]. The greater of two that touch counts.
    pub friction: f32,
    /// Share of the speed that is left after a fall on hard ground, in [0, 0.95]. A prop that bounces sets friction
    /// alone where it touches.
    pub bounce: f32,
}

/// Where something is, how it is turned, and how it moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Metres, world space, at most [`MAX_DISTANCE_M`] from the origin.
    pub position: Vec3,
    /// `world_from_prop`, a unit quaternion.
    pub rotation: Quat,
    /// Metres per second, world space, of the origin of its frame; at most [`MAX_SPEED_MPS`].
    pub velocity: Vec3,
    /// Radians per second, world space; at most [`MAX_SPIN_RADPS`].
    pub spin: Vec3,
}

impl Prop {
    /// A prop of a shape and mass, with friction 0.8, that does not bounce.
    #[must_use]
    pub fn new(solid: Solid, mass_kg: f32) -> Self {
        Self { solid, mass_kg, friction: 0.8, bounce: 0.0 }
    }

    /// A crate of so many metres a side.
    #[must_use]
    pub fn cube(side: f32, mass_kg: f32) -> Self {
        Self::new(Solid::Cuboid { half_extents: Vec3::splat(0.5 * side) }, mass_kg)
    }

    /// A ball that bounces half as fast as it falls.
    #[must_use]
    pub fn ball(radius: f32, mass_kg: f32) -> Self {
        Self { bounce: 0.5, ..Self::new(Solid::Sphere { radius }, mass_kg) }
    }

    pub(crate) fn check(&self) -> Result<(), WorldError> {
        const WHAT: &str = "a prop";
        self.solid.check(WHAT)?;
        within(WHAT, "mass_kg", self.mass_kg, MASS_RANGE_KG)?;
        within(WHAT, "friction", self.friction, FRICTION_RANGE)?;
        within(WHAT, "bounce", self.bounce, [0.0, 0.95])
    }
}

impl Motion {
    /// At rest at a point, not turned.
    #[must_use]
    pub fn at(position: Vec3) -> Self {
        Self { position, rotation: Quat::IDENTITY, velocity: Vec3::ZERO, spin: Vec3::ZERO }
    }

    /// The same, moving.
    #[must_use]
    pub fn moving(self, velocity: Vec3) -> Self {
        Self { velocity, ..self }
    }

    pub(crate) fn check(&self) -> Result<(), WorldError> {
        const WHAT: &str = "a prop";
        check_place(WHAT, self.position, self.rotation)?;
        within(WHAT, "velocity", self.velocity.length(), [0.0, MAX_SPEED_MPS])?;
        within(WHAT, "spin", self.spin.length(), [0.0, MAX_SPIN_RADPS])
    }
}

impl Solid {
    pub(crate) fn check(&self, what: &'static str) -> Result<(), WorldError> {
        let size = |field, found| within(what, field, found, SIZE_RANGE_M);
        match self {
            Solid::Sphere { radius } => size("radius", *radius),
            Solid::Capsule { radius, half_length } | Solid::Cylinder { radius, half_length } => {
                size("radius", *radius)?;
                size("half_length", *half_length)
            }
            Solid::Cuboid { half_extents } => {
                size("half_extents.x", half_extents.x)?;
                size("half_extents.y", half_extents.y)?;
                size("half_extents.z", half_extents.z)
            }
            Solid::Hull { points } => {
                if points.len() > MAX_HULL_POINTS {
                    return Err(WorldError::TooMany { what: "corners of a hull", most: MAX_HULL_POINTS });
                }
                check_points(what, points)?;
                match thickness(points) {
                    found if found >= LEAST_THICKNESS_M => Ok(()),
                    thickness_m => Err(WorldError::Flat { thickness_m }),
                }
            }
        }
    }
}

/// Checks where something is.
pub(crate) fn check_place(what: &'static str, position: Vec3, rotation: Quat) -> Result<(), WorldError> {
    within(what, "position", position.length(), [0.0, MAX_DISTANCE_M])?;
    within(what, "length of the rotation", rotation.length(), [0.999, 1.001])
}

pub(crate) fn check_points(what: &'static str, points: &[Vec3]) -> Result<(), WorldError> {
    points.iter().try_for_each(|point| within(what, "points", point.length(), [0.0, SIZE_RANGE_M[1]]))
}

/// How far the points are from the plane through the three of them that lie far apart.
fn thickness(points: &[Vec3]) -> f32 {
    let Some(&first) = points.first() else { return 0.0 };
    let farthest = |distance: &dyn Fn(Vec3) -> f32| {
        points.iter().copied().max_by(|a, b| distance(*a).total_cmp(&distance(*b))).unwrap_or(first)
    };
    let second = farthest(&|p| p.distance(first));
    let along = (second - first).normalize_or_zero();
    let third = farthest(&|p| (p - first).reject_from_normalized(along).length());
    if along == Vec3::ZERO {
        return 0.0;
    }
    let normal = along.cross(third - first).normalize_or_zero();
    let heights = || points.iter().map(|p| (*p - first).dot(normal));
    heights().fold(f32::NEG_INFINITY, f32::max) - heights().fold(f32::INFINITY, f32::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hulls_have_a_thickness() {
        let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
        assert!(thickness(&corners) > 0.3);
        assert!(thickness(&corners[..3]) < 1e-6);
        assert_eq!(thickness(&[Vec3::ONE; 7]), 0.0);
        assert_eq!(thickness(&[]), 0.0);
    }
}
