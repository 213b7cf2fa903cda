//! How deep two collision shapes are inside each other, whether the physics lets them collide or not.

use glam::{Quat, Vec3};
use physics_bridge::{Shape, ShapeKind};
use policy_core::BodyState;

use super::convex::{box_depth, box_distance, least_along, segment_distance};

/// A collision shape in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedShape {
    position: Vec3,
    world_from_shape: Quat,
    kind: ShapeKind,
}

impl PlacedShape {
    /// The shape, where its body is.
    #[must_use]
    pub fn new(shape: &Shape, body: &BodyState) -> Self {
        Self {
            position: body.position + body.rotation * shape.position,
            world_from_shape: body.rotation * shape.rotation,
            kind: shape.kind,
        }
    }

    /// The middle line of a ball or capsule, and its radius; of nothing else.
    fn round(&self) -> Option<([Vec3; 2], f32)> {
        match self.kind {
            ShapeKind::Sphere { radius } => Some(([self.position; 2], radius)),
            ShapeKind::Capsule { radius, half_length } => {
                let along = self.world_from_shape * Vec3::new(0.0, 0.0, half_length);
                Some(([self.position - along, self.position + along], radius))
            }
            _ => None,
        }
    }

    /// Half the sides of a box; zero of anything else.
    fn half_extents(&self) -> Vec3 {
        match self.kind {
            ShapeKind::Cuboid { half_extents } => half_extents,
            _ => Vec3::ZERO,
        }
    }

    fn box_axes(&self) -> [Vec3; 3] {
        let half = self.half_extents();
        let axes = [Vec3::X * half.x, Vec3::Y * half.y, Vec3::Z * half.z];
        axes.map(|axis| self.world_from_shape * axis)
    }
}

/// How far two shapes have to move to be apart, metres; negative when they are.
#[must_use]
pub fn overlap_depth(a: &PlacedShape, b: &PlacedShape) -> f32 {
    match (a.round(), b.round()) {
        (Some((line, radius)), Some((other, other_radius))) => {
            radius + other_radius - segment_distance(line, other)
        }
        (Some(round), None) => round_in_box(round, b),
        (None, Some(round)) => round_in_box(round, a),
        (None, None) => box_depth((a.position, a.box_axes()), (b.position, b.box_axes())),
    }
}

fn round_in_box((line, radius): ([Vec3; 2], f32), cuboid: &PlacedShape) -> f32 {
    let shape_from_world = cuboid.world_from_shape.inverse();
    let local = line.map(|point| shape_from_world * (point - cuboid.position));
    radius - least_along(local, |point| box_distance(point, cuboid.half_extents()))
}

#[cfg(test)]
mod tests {
    use super::*;

    const CAPSULE: ShapeKind = ShapeKind::Capsule { radius: 0.05, half_length: 0.15 };
    const CUBOID: ShapeKind = ShapeKind::Cuboid { half_extents: Vec3::new(0.09, 0.045, 0.03) };

    fn placed(kind: ShapeKind, position: Vec3, world_from_shape: Quat) -> PlacedShape {
        PlacedShape { position, world_from_shape, kind }
    }

    #[test]
    fn parallel_shins_overlap_by_what_their_radii_say() {
        let shin = placed(CAPSULE, Vec3::ZERO, Quat::IDENTITY);
        for gap in [0.02, 0.08, 0.1, 0.3] {
            let other = placed(CAPSULE, Vec3::new(0.0, gap, 0.05), Quat::IDENTITY);
            assert!((overlap_depth(&shin, &other) - (0.1 - gap)).abs() < 1e-4, "{gap}");
        }
    }

    #[test]
    fn a_shin_on_a_foot_is_as_deep_as_it_is_pressed_in() {
        let foot = placed(CUBOID, Vec3::ZERO, Quat::from_rotation_z(0.4));
        let shin = placed(CAPSULE, Vec3::new(0.0, 0.0, 0.03 + 0.15 + 0.05 - 0.02), Quat::IDENTITY);
        assert!((overlap_depth(&foot, &shin) - 0.02).abs() < 1e-4);
        assert_eq!(overlap_depth(&foot, &shin), overlap_depth(&shin, &foot));
        let lying =
            placed(CAPSULE, Vec3::new(0.0, 0.0, 0.1), Quat::from_rotation_x(std::f32::consts::FRAC_PI_2));
        assert!((overlap_depth(&foot, &lying) - (0.08 - 0.1)).abs() < 1e-4);
    }

    #[test]
    fn feet_side_by_side_do_not_overlap_and_a_ball_in_a_foot_does() {
        let foot = placed(CUBOID, Vec3::ZERO, Quat::IDENTITY);
        let beside = placed(CUBOID, Vec3::new(0.0, 0.1, 0.0), Quat::IDENTITY);
        assert!((overlap_depth(&foot, &beside) + 0.01).abs() < 1e-6);
        let on_top = placed(CUBOID, Vec3::new(0.01, 0.01, 0.05), Quat::IDENTITY);
        assert!((overlap_depth(&foot, &on_top) - 0.01).abs() < 1e-6);
        let ball = placed(ShapeKind::Sphere { radius: 0.02 }, Vec3::ZERO, Quat::IDENTITY);
        assert!((overlap_depth(&foot, &ball) - 0.05).abs() < 1e-6);
    }
}
