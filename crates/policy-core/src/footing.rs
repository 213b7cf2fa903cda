//! Footing: on uneven ground a gait is blended with its variant for rough ground, as far as the ground is uneven.
//!
//! On level ground the gait acts alone, with the bits that it has without a variant.

use crate::agility::OnGraph;
use crate::ids::NodeId;
use crate::state::CharacterState;
use crate::variants::{crossed, within};

/// Rises and drops up to the first of these count as level ground, from the second on as rough, metres.
const ROUGH_RISES: [f32; 2] = [0.01, 0.03];

/// Time from level to rough, and back, seconds. What is seen ahead is reached soon, and one step seldom comes alone.
const CROSS_SECS: [f32; 2] = [0.1, 3.0];

/// Time from rough to level on an edge that is only crossed, seconds.
const LEAVE_OFF_SECS: f32 = 0.5;

/// How uneven the ground is to a character, in [0, 1], after a tick of `dt` seconds.
///
/// An edge that is only crossed, as between a crouch and a crawl, was trained with the gaits at its ends. A variant of one of them has drifted off
/// it, and falls there. So the ground counts as level on such an edge, and from half-way to its beginning, unless both of its ends have one.
pub(crate) fn next_unevenness(before: f32, place: OnGraph<'_>, state: &CharacterState, dt: f32) -> f32 {
    let has_variant = |node: &NodeId| place.graph.node(*node).rough_ground.is_some();
    match place.crossing().is_some_and(|edge| !edge.nodes.iter().all(has_variant)) {
        true => crossed(before, 0.0, [CROSS_SECS[0], LEAVE_OFF_SECS], dt),
        false => crossed(before, within(steepest(state), ROUGH_RISES), CROSS_SECS, dt),
    }
}

/// The greatest rise or drop that a character senses, metres.
pub(crate) fn steepest(state: &CharacterState) -> f32 {
    state.ground_rises.iter().fold(0.0, |most: f32, rise| most.max(libm::fabsf(*rise)))
}
