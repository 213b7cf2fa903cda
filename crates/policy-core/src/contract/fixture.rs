//! Things that never move in a world. Every number has a range.

use alloc::sync::Arc;

use glam::{Quat, Vec2, Vec3};

use super::description_error::{DescriptionError, within};
use super::prop::FRICTION_RANGE;
use super::solid::{SIZE_RANGE_M, Solid, check_place, check_points};

/// Most triangles of a mesh.
pub const MAX_TRIANGLES: usize = 4096;

/// Most points of a height field.
pub const MAX_HEIGHTS: usize = 1 << 20;

/// Least area of a triangle, square metres.
const LEAST_AREA_M2: f32 = 1e-6;

/// Something that never moves: a ramp, a wall, stairs.
#[derive(Clone, Debug, PartialEq)]
pub struct Fixture {
    /// Its shape.
    pub shape: FixtureShape,
    /// Metres, world space, at most [`MAX_DISTANCE_M`](super::MAX_DISTANCE_M) from the origin.
    pub position: Vec3,
    /// `world_from_fixture`, a unit quaternion.
    pub rotation: Quat,
    /// Sliding friction, in [`FRICTION_RANGE`].
    pub friction: f32,
}

/// Shape of a [`Fixture`].
#[derive(Clone, Debug, PartialEq)]
pub enum FixtureShape {
    /// A convex body.
    Solid(Solid),
    /// Triangles, counter-clockwise from outside. Each is a slab of [`TRIANGLE_DEPTH_M`] below its face.
    Triangles {
        /// Corners, metres.
        points: Arc<[Vec3]>,
        /// Indices of three corners each, at most [`MAX_TRIANGLES`].
        triangles: Arc<[[u32; 3]]>,
    },
    /// Heights on a grid about the origin of the fixture, solid down to 1 m below its lowest point.
    Heights {
        /// Points along y, at least 2.
        rows: usize,
        /// Points along x, at least 2.
        columns: usize,
        /// Half the sides along x and y, metres.
        half_extents: Vec2,
        /// Metres, row by row, in [-100, 100]; x grows along a row, y from row to row.
        heights: Arc<[f32]>,
    },
}

/// Thickness of the slabs that triangles become, metres.
pub const TRIANGLE_DEPTH_M: f32 = 0.05;

impl Fixture {
    /// A fixture of a convex shape at a point, not turned, with friction 1.
    #[must_use]
    pub fn new(solid: Solid, position: Vec3) -> Self {
        let shape = FixtureShape::Solid(solid);
        Self { shape, position, rotation: Quat::IDENTITY, friction: 1.0 }
    }

    /// Checks every number.
    ///
    /// # Errors
    /// When one is out of its range; the first one is named.
    pub fn check(&self) -> Result<(), DescriptionError> {
        const WHAT: &str = "a fixture";
        check_place(WHAT, self.position, self.rotation)?;
        within(WHAT, "friction", self.friction, FRICTION_RANGE)?;
        match &self.shape {
            FixtureShape::Solid(solid) => solid.check(WHAT),
            FixtureShape::Triangles { points, triangles } => check_triangles(points, triangles),
            FixtureShape::Heights { rows, columns, half_extents, heights } => {
                within(WHAT, "rows", *rows as f32, [2.0, 4096.0])?;
                within(WHAT, "columns", *columns as f32, [2.0, 4096.0])?;
                within(WHAT, "half_extents.x", half_extents.x, [SIZE_RANGE_M[0], 10_000.0])?;
                within(WHAT, "half_extents.y", half_extents.y, [SIZE_RANGE_M[0], 10_000.0])?;
                if rows * columns != heights.len() {
                    return Err(DescriptionError::Heights { expected: rows * columns, found: heights.len() });
                }
                if heights.len() > MAX_HEIGHTS {
                    return Err(DescriptionError::TooMany { what: "heights", most: MAX_HEIGHTS });
                }
                heights.iter().try_for_each(|&h| within(WHAT, "heights", h, [-100.0, 100.0]))
            }
        }
    }
}

fn check_triangles(points: &[Vec3], triangles: &[[u32; 3]]) -> Result<(), DescriptionError> {
    check_points("a fixture", points)?;
    within("a fixture", "triangles", triangles.len() as f32, [1.0, MAX_TRIANGLES as f32])?;
    for (triangle, corners) in triangles.iter().enumerate() {
        if let Some(&found) = corners.iter().find(|&&corner| corner as usize >= points.len()) {
            return Err(DescriptionError::Corner { triangle, corners: points.len(), found });
        }
        let [a, b, c] = corners.map(|corner| points[corner as usize]);
        let found_m2 = 0.5 * (b - a).cross(c - a).length();
        if found_m2.is_nan() || found_m2 < LEAST_AREA_M2 {
            return Err(DescriptionError::Sliver { triangle, least_m2: LEAST_AREA_M2, found_m2 });
        }
    }
    Ok(())
}
