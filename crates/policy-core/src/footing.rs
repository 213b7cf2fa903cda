//! Footing: on uneven ground a gait is blended with its variant for rough ground, as far as the ground is uneven.
//!
//! Both are policies of one family, so the straight line between their parameters is a good policy too. On level ground the gait acts
//! alone, with the bits that it has without a variant.

use crate::blend::{Blend, BlendTerm};
use crate::graph::PolicyGraph;
use crate::ids::PolicyId;
use crate::state::CharacterState;

/// Rises and drops up to the first of these count as level ground, from the second on as rough, metres.
const ROUGH_RISES: [f32; 2] = [0.01, 0.03];

/// Time from level to rough, and back, seconds. What is seen ahead is reached soon, and one step seldom comes alone.
const CROSS_SECS: [f32; 2] = [0.1, 3.0];

/// How uneven the ground is, in [0, 1], after a tick of `dt` seconds.
pub(crate) fn next_unevenness(before: f32, state: &CharacterState, dt: f32) -> f32 {
    let steepest = state.ground_rises.iter().fold(0.0, |most: f32, rise| most.max(libm::fabsf(*rise)));
    let [level, rough] = ROUGH_RISES;
    let now = ((steepest - level) / (rough - level)).clamp(0.0, 1.0);
    let [to_rough, to_level] = CROSS_SECS;
    now.clamp(before - dt / to_level, before + dt / to_rough).clamp(0.0, 1.0)
}

/// The blend with a share of each policy given to its variant for rough ground, if it has one.
pub(crate) fn on_ground(graph: &PolicyGraph, blend: Blend, unevenness: f32) -> Blend {
    if unevenness <= 0.0 {
        return blend;
    }
    let mut shared = Blend::default();
    for term in blend.terms() {
        let variant = graph.nodes().get(term.policy.index()).and_then(|node| node.rough_ground);
        let shares = variant.map_or([Some((term.policy, 1.0)), None], |variant| {
            [Some((term.policy, 1.0 - unevenness)), Some((PolicyId::from(variant), unevenness))]
        });
        for (policy, share) in shares.into_iter().flatten().filter(|(_, share)| *share > 0.0) {
            let weights = term.weights.map(|weight| share * weight);
            if shared.push(BlendTerm { policy, weights }).is_err() {
                return blend;
            }
        }
    }
    shared
}
