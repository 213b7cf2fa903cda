//! Variants: a policy gives shares of its weight to others that were trained on from it: one for rough ground, one that sets off from a stand,
//! one that comes to a stand, one that turns, one that catches a push, one that does all of these, one that rests in a gait that moves or stands on
//! rough ground, one that stands still or goes straight.
//!
//! All are of one family, so the straight lines between their parameters are good policies too.

use crate::agility::{Urgency, steady_share};
use crate::blend::{Blend, BlendTerm};
use crate::graph::{Node, PolicyGraph};
use crate::ids::{NodeId, PolicyId};

/// Weight of a gait that stands from which on it counts as standing, and fully.
const STANDS: [f32; 2] = [0.5, 0.75];

/// Where a value lies between two, in [0, 1].
pub(crate) fn within(value: f32, [begins, fully]: [f32; 2]) -> f32 {
    ((value - begins) / (fully - begins)).clamp(0.0, 1.0)
}

/// A share that follows `now` from `before`, in `secs` from nothing to all and back, after a tick of `dt` seconds.
pub(crate) fn crossed(before: f32, now: f32, [to_all, to_nothing]: [f32; 2], dt: f32) -> f32 {
    now.clamp(before - dt / to_nothing, before + dt / to_all).clamp(0.0, 1.0)
}

/// A share that goes to all while something acts, and back to nothing.
pub(crate) fn switched(before: f32, acts: bool, cross: [f32; 2], dt: f32) -> f32 {
    crossed(before, if acts { 1.0 } else { 0.0 }, cross, dt)
}

/// What acts for a while after the tick that last called for it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Lasting {
    /// How far it acts, in [0, 1].
    pub(crate) share: f32,
    /// How long it goes on yet, seconds.
    pub(crate) secs: f32,
}

impl Lasting {
    /// What it is after a tick of `dt` seconds, where it lasts for `lasts` seconds and comes and goes within `cross` seconds.
    pub(crate) fn next(self, is_called_for: bool, lasts: f32, cross: [f32; 2], dt: f32) -> Self {
        let secs = if is_called_for { lasts } else { (self.secs - dt).max(0.0) };
        Self { share: switched(self.share, secs > 0.0, cross, dt), secs }
    }
}

/// How far the variants of a policy act, each in [0, 1].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Shares {
    /// Share of the catching variant.
    pub(crate) catch: f32,
    /// Share of the variant for rough ground in what that leaves. At a gait that stands its resting variant takes the place of that one.
    pub(crate) rough_ground: f32,
    /// How near to a gait that stands the character is on the graph, whatever steps it takes meanwhile.
    pub(crate) standing: f32,
    /// Share of the starting variant in what the one for rough ground leaves, then of the stopping and of the turning one, then of the agile one:
    /// of gaits that move, and of those that stand. The resting variant has a share of what they leave, and the steady one of what is left
    /// then. A gait without a resting variant rests by its agile one.
    pub(crate) agile: Urgency,
}

/// Weight of the gait that stands in a blend, where it has one.
pub(crate) fn standing_share(graph: &PolicyGraph, blend: &Blend) -> f32 {
    let stands = |term: &&BlendTerm| graph.nodes().get(term.policy.index()).is_some_and(Node::stands);
    blend.terms().iter().find(stands).map_or(0.0, |term| term.weights[0])
}

/// One of the variants of a node, where it has it.
pub(crate) type Variant = fn(&Node) -> Option<NodeId>;

/// The blend with a share of each policy given to its variants, where it has them.
pub(crate) fn with_variants(graph: &PolicyGraph, blend: Blend, shares: Shares) -> Blend {
    if shares.rough_ground <= 0.0 && shares.agile == Urgency::default() && shares.catch <= 0.0 {
        return blend;
    }
    let mut shared = Blend::default();
    for term in blend.terms() {
        let node = graph.nodes().get(term.policy.index());
        let stands = node.is_some_and(Node::stands);
        let rests = node.is_some_and(|node| node.resting.is_some());
        let Urgency { to_move, to_rest, to_stand, at_rest, as_asked, start, stop, turn, .. } = shares.agile;
        let urgency = match (stands, rests) {
            (true, _) => to_stand,
            (false, true) => to_move,
            (false, false) => to_move.max(to_rest),
        };
        // It learned to stand, not to be half-way to a walk.
        let stands_on = if stands && rests { within(shares.standing, STANDS) } else { 0.0 };
        let on_rough = shares.rough_ground * stands_on;
        let rough_ground =
            if on_rough < 1.0 { (shares.rough_ground - on_rough) / (1.0 - on_rough) } else { 0.0 };
        let steadily = steady_share(if stands { at_rest } else { as_asked });
        // Each has a share of what those before it leave.
        let takers: [(Variant, f32); 9] = [
            (|node| node.catching, shares.catch),
            (|node| node.resting, on_rough),
            (|node| node.rough_ground, rough_ground),
            (|node| node.starting, start.share),
            (|node| node.stopping, stop.share),
            (|node| node.turning, turn.share),
            (|node| node.agile, urgency),
            (|node| node.resting, if stands { 0.0 } else { to_rest }),
            (|node| node.steady, steadily),
        ];
        let mut left = 1.0;
        let variants = takers.map(|(variant, share)| {
            let variant = node.and_then(variant)?;
            let taken = left * share;
            left -= taken;
            Some((PolicyId::from(variant), taken))
        });
        let parts = core::iter::once(Some((term.policy, left))).chain(variants);
        for (policy, share) in parts.flatten().filter(|(_, share)| *share > 0.0) {
            let weights = term.weights.map(|weight| share * weight);
            if shared.add(BlendTerm { policy, weights }).is_err() {
                return blend;
            }
        }
    }
    shared
}
