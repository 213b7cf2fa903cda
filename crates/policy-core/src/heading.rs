//! The heading frame: the world turned about z so that the pelvis' x axis lies in its xz plane.
//! Observations and discriminator features are all expressed in it.

use glam::{Quat, Vec2, Vec3};

/// A turn about the vertical, kept as cosine and sine so that no transcendental function is needed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heading {
    cos: f32,
    sin: f32,
}

impl Heading {
    /// Facing along world x.
    pub const FORWARD: Heading = Heading { cos: 1.0, sin: 0.0 };

    /// Heading of a body with rotation `world_from_body`. A body whose x axis is vertical faces along world x.
    #[must_use]
    pub fn from_rotation(world_from_body: Quat) -> Self {
        Self::from_direction((world_from_body * Vec3::X).truncate())
    }

    /// Heading of a horizontal direction of any length. A zero or non-finite direction gives [`Heading::FORWARD`].
    #[must_use]
    pub fn from_direction(direction: Vec2) -> Self {
        let length = libm::sqrtf(direction.x * direction.x + direction.y * direction.y);
        if length > 1e-6 && length.is_finite() {
            Self { cos: direction.x / length, sin: direction.y / length }
        } else {
            Self::FORWARD
        }
    }

    /// Heading turned by `radians` from world x, counter-clockwise seen from above.
    #[must_use]
    pub fn from_angle(radians: f32) -> Self {
        Self { cos: libm::cosf(radians), sin: libm::sinf(radians) }
    }

    /// Angle from world x, in (-pi, pi].
    #[must_use]
    pub fn angle(self) -> f32 {
        libm::atan2f(self.sin, self.cos)
    }

    /// Horizontal unit vector of this heading, world space.
    #[must_use]
    pub fn direction(self) -> Vec2 {
        Vec2::new(self.cos, self.sin)
    }

    /// A world vector expressed in the heading frame.
    #[must_use]
    #[inline]
    pub fn heading_from_world(self, v: Vec3) -> Vec3 {
        Vec3::new(self.cos * v.x + self.sin * v.y, self.cos * v.y - self.sin * v.x, v.z)
    }

    /// Angle between this heading and a horizontal world direction of any length, in [0, pi].
    pub(crate) fn angle_off(self, direction: Vec2) -> f32 {
        let local = self.heading_from_world_2d(direction);
        libm::fabsf(libm::atan2f(local.y, local.x))
    }

    /// A horizontal world vector expressed in the heading frame.
    #[must_use]
    #[inline]
    pub fn heading_from_world_2d(self, v: Vec2) -> Vec2 {
        Vec2::new(self.cos * v.x + self.sin * v.y, self.cos * v.y - self.sin * v.x)
    }

    /// A horizontal vector of the heading frame expressed in the world.
    #[must_use]
    pub fn world_from_heading_2d(self, v: Vec2) -> Vec2 {
        Vec2::new(self.cos * v.x - self.sin * v.y, self.sin * v.x + self.cos * v.y)
    }
}

/// The x and z axes of a rotation, without building the whole matrix: the six numbers that stand for a
/// rotation in observations.
#[inline]
pub(crate) fn axes_xz(q: Quat) -> (Vec3, Vec3) {
    let (x2, y2, z2) = (q.x + q.x, q.y + q.y, q.z + q.z);
    let (xx, xy, xz) = (q.x * x2, q.x * y2, q.x * z2);
    let (yy, yz, zz) = (q.y * y2, q.y * z2, q.z * z2);
    let (wx, wy, wz) = (q.w * x2, q.w * y2, q.w * z2);
    (Vec3::new(1.0 - (yy + zz), xy + wz, xz - wy), Vec3::new(xz + wy, yz - wx, 1.0 - (xx + yy)))
}

/// The product of two rotations: `b`, then `a`.
///
/// glam sums the terms of a component in one order with SIMD and in another without. This is the order of its SIMD code, so the bits are the
/// same on every machine.
#[inline]
pub(crate) fn product(a: Quat, b: Quat) -> Quat {
    Quat::from_xyzw(
        (a.w * b.x + a.x * b.w) + (a.y * b.z - a.z * b.y),
        (a.w * b.y - a.x * b.z) + (a.y * b.w + a.z * b.x),
        (a.w * b.z + a.x * b.y) + (a.z * b.w - a.y * b.x),
        (a.w * b.w - a.x * b.x) - (a.y * b.y + a.z * b.z),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Quaternions of length 1 that are the same on every machine.
    fn rotations() -> impl Iterator<Item = Quat> {
        let mut seed = 7u32;
        let mut number = move || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 8) as f32 / (1 << 23) as f32 - 1.0
        };
        core::iter::repeat_with(move || {
            let [x, y, z, w] = core::array::from_fn(|_| number());
            let length = libm::sqrtf(x * x + y * y + z * z + w * w).max(1e-3);
            Quat::from_xyzw(x / length, y / length, z / length, w / length)
        })
    }

    /// Of the products of glam's SSE2 code.
    const PRODUCTS: u64 = 0x2fa3_1aba_a6c7_2fc7;

    #[test]
    fn products_have_the_same_bits_on_every_machine() {
        let hash = |hash: u64, part: f32| (hash ^ u64::from(part.to_bits())).wrapping_mul(0x100_0000_01b3);
        let (mut ours, mut scalar) = (0xcbf2_9ce4_8422_2325, 0);
        for (a, b) in rotations().zip(rotations().skip(1)).take(1000) {
            let is = product(a, b);
            assert!((is - a * b).length() < 1e-6);
            ours = is.to_array().into_iter().fold(ours, hash);
            // The order of glam's code without SIMD.
            let x = a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y;
            scalar += i32::from(x.to_bits() != is.x.to_bits());
        }
        assert_eq!(ours, PRODUCTS, "{ours:#x}");
        assert!(scalar > 100, "the order matters: {scalar}");
    }

    #[test]
    fn a_turned_body_faces_its_heading() {
        let heading = Heading::from_rotation(Quat::from_rotation_z(0.7) * Quat::from_rotation_y(0.4));
        assert!((heading.angle() - 0.7).abs() < 1e-6);
        let forward = heading.heading_from_world(Vec3::new(libm::cosf(0.7), libm::sinf(0.7), 2.0));
        assert!((forward - Vec3::new(1.0, 0.0, 2.0)).length() < 1e-6);
    }

    #[test]
    fn a_vertical_body_has_a_heading() {
        assert_eq!(Heading::from_direction(Vec2::ZERO), Heading::FORWARD);
        assert_eq!(Heading::from_direction(Vec2::new(f32::NAN, 1.0)), Heading::FORWARD);
    }

    #[test]
    fn axes_agree_with_the_matrix() {
        let q = Quat::from_xyzw(0.1, -0.5, 0.3, 0.8).normalize();
        let (x, z) = axes_xz(q);
        assert!((x - q * Vec3::X).length() < 1e-6 && (z - q * Vec3::Z).length() < 1e-6);
    }
}
