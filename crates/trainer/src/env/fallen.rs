//! The fall rule of training: stricter than a game's, which looks at the pelvis alone.

use policy_core::{Body, CharacterState};

/// Least heights of an upright body above the ground, metres: body frames, not lowest points.
const LEAST_HEIGHTS: [(Body, f32); 9] = [
    (Body::Pelvis, 0.45),
    (Body::Torso, 0.6),
    (Body::Head, 0.75),
    (Body::RightHand, 0.15),
    (Body::LeftHand, 0.15),
    (Body::RightLowerArm, 0.3),
    (Body::LeftLowerArm, 0.3),
    (Body::RightThigh, 0.4),
    (Body::LeftThigh, 0.4),
];

/// True when a body that should be up has come low; `factor` scales the heights.
#[must_use]
pub fn fallen(state: &CharacterState, factor: f32) -> bool {
    LEAST_HEIGHTS
        .iter()
        .any(|(body, height)| state.body(*body).position.z - state.ground_height < height * factor)
}
