//! Between Bevy's world and the policies': y up there, z up here. Both are right-handed, in metres.
//!
//! Policies see z up and x ahead. `x` is the same in both, `y` of Bevy is `z` of the policies, `z` of Bevy is `-y`.

use core::f32::consts::FRAC_1_SQRT_2;

use bevy::math::{Quat, Vec2, Vec3};
use policy_core::{BodyState, CharacterState, Heading};

/// Turns vectors of the policies' world into Bevy's: by -90 degrees about x.
const BEVY_FROM_POLICY: Quat = Quat::from_xyzw(-FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2);

/// A vector of the policies' world in Bevy's.
#[must_use]
pub fn to_bevy(v: Vec3) -> Vec3 {
    Vec3::new(v.x, v.z, -v.y)
}

/// A vector of Bevy's world in the policies'.
#[must_use]
pub fn from_bevy(v: Vec3) -> Vec3 {
    Vec3::new(v.x, -v.z, v.y)
}

/// The same rotation of a body, from the policies' world to Bevy's. The body's own axes stay those of the MJCF.
#[must_use]
pub fn rotation_to_bevy(rotation: Quat) -> Quat {
    BEVY_FROM_POLICY * rotation
}

/// The same rotation of a body, from Bevy's world to the policies'.
#[must_use]
pub fn rotation_from_bevy(rotation: Quat) -> Quat {
    BEVY_FROM_POLICY.conjugate() * rotation
}

/// The point on the ground below a point of Bevy's world, as policies have it.
#[must_use]
pub fn ground_from_bevy(v: Vec3) -> Vec2 {
    from_bevy(v).truncate()
}

/// Where something of this rotation faces: Bevy's forward is -z.
#[must_use]
pub fn heading_from_bevy(rotation: Quat) -> Heading {
    Heading::from_direction(ground_from_bevy(rotation * Vec3::NEG_Z))
}

/// The rotation whose forward, -z, is this heading.
#[must_use]
pub fn heading_to_bevy(heading: Heading) -> Quat {
    Quat::from_rotation_y(heading.angle() - core::f32::consts::FRAC_PI_2)
}

/// Turns a state that was sensed in Bevy's world into the policies'. The height of the ground stays.
pub(crate) fn turn_state(state: &mut CharacterState) {
    for body in &mut state.bodies {
        *body = BodyState {
            position: from_bevy(body.position),
            rotation: rotation_from_bevy(body.rotation),
            linear_velocity: from_bevy(body.linear_velocity),
            angular_velocity: from_bevy(body.angular_velocity),
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vectors_and_rotations_agree_and_come_back() {
        let v = Vec3::new(1.0, 2.0, 3.0);
        assert_eq!(from_bevy(to_bevy(v)), v);
        assert!((BEVY_FROM_POLICY * v - to_bevy(v)).length() < 1e-6);
        let q = Quat::from_xyzw(0.1, -0.5, 0.3, 0.8).normalize();
        assert!(rotation_from_bevy(rotation_to_bevy(q)).dot(q).abs() > 1.0 - 1e-6);
        assert_eq!(to_bevy(Vec3::Z), Vec3::Y);
    }

    #[test]
    fn a_heading_is_the_forward_of_its_rotation() {
        for angle in [0.0, 0.7, -2.0] {
            let heading = Heading::from_angle(angle);
            let rotation = heading_to_bevy(heading);
            assert!((heading_from_bevy(rotation).angle() - angle).abs() < 1e-5, "{angle}");
            let ahead = to_bevy(heading.direction().extend(0.0));
            assert!((rotation * Vec3::NEG_Z - ahead).length() < 1e-5, "{angle}");
        }
    }
}
