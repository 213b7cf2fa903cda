//! Feet that slide while they bear weight.

use glam::Vec3;
use physics_bridge::{Shape, ShapeKind};
use policy_core::BodyState;

use crate::trial::Trial;

/// A foot that bears this share of the weight stands.
const LEAST_LOAD: f32 = 0.05;

/// Gravity, metres per second squared.
const GRAVITY: f32 = 9.81;

/// Mean speed of the lowest points of standing feet.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FootSlide {
    sum_mps: f32,
    count: u32,
}

impl FootSlide {
    /// Takes the tick that a trial has just had.
    pub fn tick(&mut self, trial: &Trial) {
        let weight = trial.character.model().described().mass_kg() as f32 * GRAVITY;
        for &foot in trial.controller.pack().skeleton().feet() {
            if trial.character.ground_load(foot) >= LEAST_LOAD * weight {
                let shapes =
                    trial.character.model().described().shapes().iter().filter(|shape| shape.body == foot);
                self.add(lowest_point_velocity(shapes, trial.state.body(foot)));
            }
        }
    }

    /// Takes the velocity of a point that stands, metres per second.
    fn add(&mut self, velocity: Vec3) {
        self.sum_mps += velocity.truncate().length();
        self.count += 1;
    }

    /// Mean horizontal speed, metres per second; 0 when no foot has stood.
    #[must_use]
    pub fn mean_mps(&self) -> f32 {
        self.sum_mps / self.count.max(1) as f32
    }
}

/// Velocity of the lowest point of the shapes of a body, metres per second.
fn lowest_point_velocity<'a>(shapes: impl Iterator<Item = &'a Shape>, body: &BodyState) -> Vec3 {
    let lowest =
        shapes.map(|shape| body.rotation * lowest_point(shape, body)).min_by(|a, b| a.z.total_cmp(&b.z));
    lowest.map_or(body.linear_velocity, |arm| body.linear_velocity + body.angular_velocity.cross(arm))
}

/// Lowest point of a shape, in the frame of its body, metres.
fn lowest_point(shape: &Shape, body: &BodyState) -> Vec3 {
    let shape_from_world = (body.rotation * shape.rotation).inverse();
    let down = shape_from_world * Vec3::NEG_Z;
    let point = match shape.kind {
        ShapeKind::Capsule { radius, half_length } => {
            down * radius + Vec3::new(0.0, 0.0, half_length * down.z.signum())
        }
        ShapeKind::Cuboid { half_extents } => half_extents * down.signum(),
        ShapeKind::Sphere { radius } => down * radius,
        _ => Vec3::ZERO,
    };
    shape.position + shape.rotation * point
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Quat;
    use policy_core::BodyId;

    const SOLE: Shape = Shape {
        body: BodyId::new(0),
        position: Vec3::new(0.05, 0.0, 0.0),
        rotation: Quat::IDENTITY,
        kind: ShapeKind::Cuboid { half_extents: Vec3::new(0.1, 0.05, 0.03) },
    };

    #[test]
    fn a_foot_that_rolls_over_its_toe_does_not_slide() {
        // Pitched toe down by 0.3 rad, turning about the toe.
        let rotation = Quat::from_rotation_y(0.3);
        let toe = rotation * Vec3::new(0.15, 0.0, -0.03);
        let angular_velocity = Vec3::new(0.0, 2.0, 0.0);
        let body = BodyState {
            rotation,
            angular_velocity,
            linear_velocity: -angular_velocity.cross(toe),
            ..BodyState::default()
        };
        let velocity = lowest_point_velocity([SOLE].iter(), &body);
        assert!(velocity.truncate().length() < 1e-5, "{velocity}");
    }

    #[test]
    fn a_foot_that_is_dragged_slides_as_fast_as_it_is_dragged() {
        let body = BodyState { linear_velocity: Vec3::new(0.3, 0.4, 0.1), ..BodyState::default() };
        let mut slide = FootSlide::default();
        slide.add(lowest_point_velocity([SOLE].iter(), &body));
        slide.add(Vec3::ZERO);
        assert!((slide.mean_mps() - 0.25).abs() < 1e-6);
        assert_eq!(FootSlide::default().mean_mps(), 0.0);
    }

    #[test]
    fn the_lowest_point_of_a_capsule_is_below_its_lower_end() {
        let kind = ShapeKind::Capsule { radius: 0.05, half_length: 0.2 };
        let shape = Shape { kind, position: Vec3::ZERO, ..SOLE };
        let upside_down = BodyState { rotation: Quat::from_rotation_x(3.0), ..BodyState::default() };
        let point = upside_down.rotation * lowest_point(&shape, &upside_down);
        assert!((point.z - (-0.05 - 0.2 * 3.0_f32.cos().abs())).abs() < 1e-5, "{point}");
    }
}
