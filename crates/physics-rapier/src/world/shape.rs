//! Shapes of props and fixtures as Rapier's colliders.

use policy_core::contract::{Fixture, FixtureShape, Solid};
use rapier3d::dynamics::CoefficientCombineRule;
use rapier3d::geometry::{Array2, ColliderBuilder};
use rapier3d::math::{Pose, Rotation, Vector};
use rapier3d::parry::shape::{HeightFieldFlags, TriMeshFlags};

use super::WorldError;

/// The collider of a convex body. Rapier's cylinders and capsules lie along y, those of the contract along z.
pub(super) fn of_solid(solid: &Solid) -> Result<ColliderBuilder, WorldError> {
    Ok(match solid {
        Solid::Sphere { radius } => ColliderBuilder::ball(*radius),
        Solid::Capsule { radius, half_length } => ColliderBuilder::capsule_z(*half_length, *radius),
        Solid::Cylinder { radius, half_length } => {
            ColliderBuilder::cylinder(*half_length, *radius).position(upright())
        }
        Solid::Cuboid { half_extents: Vector { x, y, z } } => ColliderBuilder::cuboid(*x, *y, *z),
        Solid::Hull { points } => ColliderBuilder::convex_hull(points).ok_or(WorldError::Hull)?,
    })
}

/// The collider of something that never moves, where it is.
pub(super) fn of_fixture(fixture: &Fixture) -> Result<ColliderBuilder, WorldError> {
    let place = Pose::from_parts(fixture.position, fixture.rotation);
    let collider = match &fixture.shape {
        FixtureShape::Solid(solid) => of_solid(solid)?,
        FixtureShape::Triangles { points, triangles } => {
            // Without the flag a foot that slides over an edge between two triangles stumbles over it.
            let flags = TriMeshFlags::FIX_INTERNAL_EDGES;
            ColliderBuilder::trimesh_with_flags(points.to_vec(), triangles.to_vec(), flags)
                .map_err(|_| WorldError::Hull)?
        }
        FixtureShape::Heights { rows, columns, half_extents, heights } => {
            of_heights([*rows, *columns], half_extents.to_array(), heights)
        }
    };
    let local = collider.position;
    Ok(rough(collider.position(place * local), fixture.friction))
}

/// The collider of heights on a grid about the origin, row by row, metres: `[rows, columns]`, half the sides along x and y.
///
/// Rapier's height fields have y up and their rows along z. Turned upright, the rows run against y.
pub(crate) fn of_heights(
    [rows, columns]: [usize; 2],
    [half_x, half_y]: [f32; 2],
    heights: &[f32],
) -> ColliderBuilder {
    let height = |row: usize, column: usize| heights[(rows - 1 - row) * columns + column];
    let scale = Vector::new(2.0 * half_x, 1.0, 2.0 * half_y);
    // Without the flag a foot that slides over an edge between two triangles stumbles over it.
    let flags = HeightFieldFlags::FIX_INTERNAL_EDGES;
    ColliderBuilder::heightfield_with_flags(Array2::from_fn(rows, columns, height), scale, flags)
        .position(upright())
}

/// With a friction of which, as in the contract, the greater of two that touch counts.
pub(super) fn rough(collider: ColliderBuilder, friction: f32) -> ColliderBuilder {
    collider.friction(friction).friction_combine_rule(CoefficientCombineRule::Max)
}

/// Turns y to z.
fn upright() -> Pose {
    Pose::from_parts(Vector::ZERO, Rotation::from_rotation_x(std::f32::consts::FRAC_PI_2))
}
