//! Pushes aside: a gait that a push tips over to a side stands for a moment, by a policy that has learned to keep its balance.
//!
//! A gait puts one foot before the other and has none beside the body. A policy that stands steps aside, and is free to. It acts alone,
//! and at once: it need not be of the gait's family, so what lies between their parameters is no policy.

use glam::Vec2;

use crate::graph::PolicyGraph;
use crate::ids::NodeId;
use crate::path::GraphPosition;
use crate::variants::Lasting;

/// A body that would come to rest so far beside its ankles tips over, as a share of its height above them.
const ASIDE: f32 = 0.25;

/// On ground as uneven as this it does not stand; see [`Shares::rough_ground`](crate::variants::Shares::rough_ground).
const MOST_UNEVENNESS: f32 = 0.5;

/// It stands for so long after the body last tipped over, seconds.
const STANDS_SECS: f32 = 0.5;

/// Time from a gait to the policy that stands, and back, seconds. The first is no longer than a tick.
const CROSS_SECS: [f32; 2] = [0.03, 0.1];

/// What a catch remembers from tick to tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct PushedAside {
    /// How far the policy that stands acts.
    pub(crate) acts: Lasting,
    /// Whether the body tipped over to its left.
    pub(crate) left: bool,
}

impl PushedAside {
    /// What it is after a tick of `dt` seconds at a position on the graph. A gait that does not go at its pace yet, in a start or a turn,
    /// leans by itself, and uneven ground is nothing that the policy that stands has learned. The body comes to rest as
    /// [`comes_to_rest`](crate::balance::comes_to_rest) says.
    pub(crate) fn next(
        self,
        (graph, position): (&PolicyGraph, GraphPosition),
        comes_to_rest: Option<Vec2>,
        (at_pace, unevenness): (f32, f32),
        dt: f32,
    ) -> Self {
        let catches = |node: NodeId| graph.node(node).pushed_aside.is_some();
        if !(catches(position.from) && catches(position.to)) {
            return Self::default();
        }
        let acts_already = self.acts.share > 0.0;
        let can_tip = (at_pace >= 1.0 || acts_already) && unevenness < MOST_UNEVENNESS;
        let tips = comes_to_rest.filter(|at| can_tip && at.y.abs() > ASIDE);
        let acts = self.acts.next(tips.is_some(), STANDS_SECS, CROSS_SECS, dt);
        let left = match tips {
            Some(at) if !acts_already => at.y > 0.0,
            _ => self.left,
        };
        if acts.share > 0.0 { Self { acts, left } } else { Self::default() }
    }

    /// Whether the policy that stands acts, for the most part: it has no target.
    pub(crate) fn stands(&self) -> bool {
        self.acts.share > 0.5
    }

    /// Which of a pair of policies acts: the one for its left, or for its right.
    pub(crate) fn of(&self, [left, right]: [NodeId; 2]) -> NodeId {
        if self.left { left } else { right }
    }
}
