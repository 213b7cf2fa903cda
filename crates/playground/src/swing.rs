//! What keeps a pendulum at its height.

use glam::Vec3;
use policy_core::contract::{Joint, Motion};

use super::PlacedProp;

/// Standard gravity, metres per second squared.
const GRAVITY: f32 = 9.81;
/// Share of the energy that may be lacking.
const SLACK: f32 = 0.02;
/// A slower pendulum has no direction to push along, metres per second.
const LEAST_MPS: f32 = 0.05;
/// Largest acceleration, metres per second squared, and that for each joule a kilogram lacks.
const MOST_MPS2: f32 = 1.5;
const PER_ENERGY: f32 = 0.5;

impl PlacedProp {
    /// How fast the phase of its swing turns at the height that it is driven to, radians a second. `None` when it is no pendulum.
    #[must_use]
    pub fn swing_radps(&self) -> Option<f32> {
        let (height_m, anchor) = (self.swing_m?, self.joint.as_ref().and_then(Joint::anchor)?);
        let length = anchor.distance(self.position).max(height_m / 2.0);
        // A wide swing takes longer than a small one: the first term of the series of its period.
        let widest = (1.0 - height_m / length).acos();
        Some((GRAVITY / length).sqrt() / (1.0 + widest * widest / 16.0))
    }

    /// The force that keeps it swinging while it moves like this, newtons, world space: along its motion while it has less energy
    /// than [`PlacedProp::swing_m`] asks for. `None` when it needs no push or is no pendulum.
    #[must_use]
    pub fn swing_force(&self, motion: &Motion) -> Option<Vec3> {
        let (height_m, anchor) = (self.swing_m?, self.joint.as_ref().and_then(Joint::anchor)?);
        let (position, velocity) = (motion.position, motion.velocity);
        let lowest = anchor.z - anchor.distance(position);
        let lacking = GRAVITY * (height_m - (position.z - lowest)) - 0.5 * velocity.length_squared();
        let pushed = lacking > SLACK * GRAVITY * height_m && velocity.length() > LEAST_MPS;
        pushed.then(|| velocity.normalize() * (self.prop.mass_kg * (PER_ENERGY * lacking).min(MOST_MPS2)))
    }
}

#[cfg(test)]
mod tests {
    use glam::Quat;
    use policy_core::contract::Prop;

    use super::*;
    use crate::Paint;

    /// A bob of 10 kg, two metres below what it hangs from, that is driven to a height.
    fn pendulum(height_m: f32) -> PlacedProp {
        PlacedProp {
            name: "bob".into(),
            prop: Prop::ball(0.2, 10.0),
            position: Vec3::Z,
            rotation: Quat::IDENTITY,
            paint: Paint::Red,
            joint: Some(Joint::Ball { anchor: Vec3::Z * 3.0, damping: 0.0 }),
            swing_m: Some(height_m),
        }
    }

    #[test]
    fn a_pendulum_that_is_too_slow_is_pushed_along_and_one_that_is_not_is_left_alone() {
        let force = |speed: f32| pendulum(0.5).swing_force(&Motion::at(Vec3::Z).moving(Vec3::X * speed));
        // Half a metre needs the square root of 2 g h at the bottom: 3.13 m/s.
        let pushed = force(1.0).expect("it is slow");
        assert!(pushed.x > 5.0 && pushed.x <= 15.0 && pushed.y == 0.0, "{pushed}");
        assert_eq!((force(3.13), force(0.01)), (None, None));
    }

    #[test]
    fn a_wide_swing_takes_longer_than_a_small_one() {
        let secs = |height_m: f32| std::f32::consts::TAU / pendulum(height_m).swing_radps().unwrap();
        // Two metres: 2.84 s for a small swing; a wide one of 60 degrees takes 7.3 % longer.
        assert!((secs(1e-4) - 2.837).abs() < 0.001, "{}", secs(1e-4));
        assert!((secs(1.0) / secs(1e-4) - 1.073).abs() < 0.006, "{}", secs(1.0) / secs(1e-4));
        assert_eq!(PlacedProp { joint: None, ..pendulum(0.5) }.swing_radps(), None);
    }
}
