//! Convex bodies. Every number has a range.

use alloc::sync::Arc;

use glam::{Quat, Vec3};

use super::MAX_DISTANCE_M;
use super::description_error::{DescriptionError, within};

/// Range of a radius, a half length or half a side, metres.
pub const SIZE_RANGE_M: [f32; 2] = [0.005, 100.0];

/// Most corners of a hull.
pub const MAX_HULL_POINTS: usize = 256;

/// Least thickness of a hull, metres.
const LEAST_THICKNESS_M: f32 = 0.002;

/// A convex body, in its own frame. Sizes are metres, in [`SIZE_RANGE_M`].
#[derive(Clone, Debug, PartialEq)]
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

impl Solid {
    pub(super) fn check(&self, what: &'static str) -> Result<(), DescriptionError> {
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
                    return Err(DescriptionError::TooMany {
                        what: "corners of a hull",
                        most: MAX_HULL_POINTS,
                    });
                }
                check_points(what, points)?;
                match thickness(points) {
                    found if found >= LEAST_THICKNESS_M => Ok(()),
                    thickness_m => Err(DescriptionError::Flat { thickness_m }),
                }
            }
        }
    }
}

/// Checks where something is.
pub(super) fn check_place(
    what: &'static str,
    position: Vec3,
    rotation: Quat,
) -> Result<(), DescriptionError> {
    within(what, "position", position.length(), [0.0, MAX_DISTANCE_M])?;
    within(what, "length of the rotation", rotation.length(), [0.999, 1.001])
}

pub(super) fn check_points(what: &'static str, points: &[Vec3]) -> Result<(), DescriptionError> {
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
