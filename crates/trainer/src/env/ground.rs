//! How low a body reaches: what lifts clips and start states out of the floor.

use glam::Vec3;
use policy_core::{Body, CharacterState};

/// A ball around a point of a body frame, metres. Capsules are covered by their ends, the feet by their corners.
const BALLS: [(Body, [f32; 3], f32); 29] = [
    (Body::Pelvis, [0.0, 0.0, 0.07], 0.09),
    (Body::Pelvis, [0.0, 0.0, 0.205], 0.07),
    (Body::Torso, [0.0, 0.0, 0.12], 0.11),
    (Body::Torso, [-0.017, -0.128, 0.238], 0.045),
    (Body::Torso, [-0.017, 0.128, 0.238], 0.045),
    (Body::Head, [0.0, 0.0, 0.175], 0.095),
    (Body::RightUpperArm, [0.0, 0.0, -0.05], 0.045),
    (Body::RightUpperArm, [0.0, 0.0, -0.23], 0.045),
    (Body::RightLowerArm, [0.0, 0.0, -0.0525], 0.04),
    (Body::RightLowerArm, [0.0, 0.0, -0.1875], 0.04),
    (Body::RightHand, [0.0; 3], 0.04),
    (Body::LeftUpperArm, [0.0, 0.0, -0.05], 0.045),
    (Body::LeftUpperArm, [0.0, 0.0, -0.23], 0.045),
    (Body::LeftLowerArm, [0.0, 0.0, -0.0525], 0.04),
    (Body::LeftLowerArm, [0.0, 0.0, -0.1875], 0.04),
    (Body::LeftHand, [0.0; 3], 0.04),
    (Body::RightThigh, [0.0, 0.0, -0.06], 0.055),
    (Body::RightThigh, [0.0, 0.0, -0.36], 0.055),
    (Body::RightShin, [0.0, 0.0, -0.355], 0.05),
    (Body::LeftThigh, [0.0, 0.0, -0.06], 0.055),
    (Body::LeftThigh, [0.0, 0.0, -0.36], 0.055),
    (Body::LeftShin, [0.0, 0.0, -0.355], 0.05),
    (Body::RightShin, [0.0, 0.0, -0.045], 0.05),
    (Body::RightFoot, [0.1335, 0.045, -0.05], 0.0),
    (Body::RightFoot, [0.1335, -0.045, -0.05], 0.0),
    (Body::RightFoot, [-0.0435, 0.0, -0.05], 0.0),
    (Body::LeftFoot, [0.1335, 0.045, -0.05], 0.0),
    (Body::LeftFoot, [0.1335, -0.045, -0.05], 0.0),
    (Body::LeftFoot, [-0.0435, 0.0, -0.05], 0.0),
];

/// Height of the lowest point of the character above the ground below its pelvis, metres; negative inside it.
#[must_use]
pub fn lowest_point(state: &CharacterState) -> f32 {
    let height = |(body, centre, radius): &(Body, [f32; 3], f32)| {
        let body = state.body(*body);
        (body.position + body.rotation * Vec3::from_array(*centre)).z - radius
    };
    BALLS.iter().map(height).fold(f32::INFINITY, f32::min) - state.ground_height
}
