//! Between Rapier's glam and ours. No other module names both.

use policy_core::glam::{Quat, Vec3};
use rapier3d::math::{Rotation, Vector};

/// A vector of Rapier as ours.
pub(crate) fn vec3(v: Vector) -> Vec3 {
    Vec3::from_array(v.to_array())
}

/// A vector of ours as Rapier's.
pub(crate) fn vector(v: Vec3) -> Vector {
    Vector::from_array(v.to_array())
}

/// A rotation of Rapier as ours; both are xyzw.
pub(crate) fn quat(r: Rotation) -> Quat {
    Quat::from_array(r.to_array())
}
