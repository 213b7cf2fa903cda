//! What keeps a pendulum at its height.

use glam::Vec3;

/// Standard gravity, metres per second squared.
const GRAVITY: f32 = 9.81;
/// Share of the energy that may be lacking.
const SLACK: f32 = 0.02;
/// A slower pendulum has no direction to push along, metres per second.
const LEAST_MPS: f32 = 0.05;
/// Largest acceleration, metres per second squared, and that for each joule a kilogram lacks.
const MOST_MPS2: f32 = 1.5;
const PER_ENERGY: f32 = 0.5;

/// The force on a pendulum that is to rise to `height_m` above its lowest point, newtons, world space: along its motion while
/// it has less energy. `None` when it needs no push. Positions are metres, the velocity metres per second, world space.
#[must_use]
pub fn swing_force(
    height_m: f32,
    mass_kg: f32,
    anchor: Vec3,
    position: Vec3,
    velocity: Vec3,
) -> Option<Vec3> {
    let lowest = anchor.z - anchor.distance(position);
    let lacking = GRAVITY * (height_m - (position.z - lowest)) - 0.5 * velocity.length_squared();
    let pushed = lacking > SLACK * GRAVITY * height_m && velocity.length() > LEAST_MPS;
    pushed.then(|| velocity.normalize() * (mass_kg * (PER_ENERGY * lacking).min(MOST_MPS2)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pendulum_that_is_too_slow_is_pushed_along_and_one_that_is_not_is_left_alone() {
        let (anchor, lowest) = (Vec3::Z * 3.0, Vec3::Z);
        let force = |speed: f32| swing_force(0.5, 10.0, anchor, lowest, Vec3::X * speed);
        // Half a metre needs the square root of 2 g h at the bottom: 3.13 m/s.
        let pushed = force(1.0).expect("it is slow");
        assert!(pushed.x > 5.0 && pushed.x <= 15.0 && pushed.y == 0.0, "{pushed}");
        assert_eq!((force(3.13), force(0.01)), (None, None));
    }
}
