//! From MuJoCo's conventions to glam's.

use glam::Quat;

/// MuJoCo's wxyz quaternion in single precision.
pub(crate) fn rotation([w, x, y, z]: [f64; 4]) -> Quat {
    Quat::from_xyzw(x as f32, y as f32, z as f32, w as f32)
}
