//! Fall detection and standing up: one rule for every user of the graph.
//!
//! A character has fallen when its root stays lower than the policies in use allow. Leaving a low gait requires
//! standing first.

use glam::Vec3;

use crate::graph::PolicyGraph;
use crate::path::GraphPosition;
use crate::skeleton::Skeleton;
use crate::state::CharacterState;

/// Seconds that the root must stay low.
const FALL_SECONDS: f32 = 0.3;

/// A character has stood up when its root is this much above the fall height, metres.
const RISEN_METRES: f32 = 0.1;

/// Its head must be this much above the root as well, metres: a character with its head down is about to go down again.
const HEAD_UP_METRES: f32 = 0.2;

/// A gait is upright when its fall height is at least this share of the greatest of the graph.
const UPRIGHT_SHARE: f32 = 0.75;

/// A root that leans over by more than the angle of this cosine lies. It may lie on something that is high.
const LYING_COSINE: f32 = 0.5;

/// Seconds that the root must lie.
const LYING_SECONDS: f32 = 1.5;

/// Seconds that standing up may take, out of a low gait, before it counts as a fall.
pub const RISE_SECONDS: f32 = 3.0;

/// Seconds after which standing up is late: the recovery skill takes over, or the character acts to and fro along the edge.
pub const LATE_RISE_SECONDS: f32 = 0.8;

/// Seconds of one turn to and fro.
const SWING_SECONDS: f32 = 1.1;

/// How far back along the edge it goes.
const SWING: f32 = 0.6;

/// Heights above the ground that the rules need, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heights {
    /// Of the root.
    pub root: f32,
    /// Of the head; that of the root plus enough to count as up for a skeleton without a head.
    pub head: f32,
}

impl Heights {
    /// Heights of a character.
    ///
    /// # Panics
    /// When the state does not fit the skeleton.
    #[must_use]
    pub fn of(skeleton: &Skeleton, state: &CharacterState) -> Self {
        let root = state.root_height();
        let head = skeleton.head().map_or(f32::INFINITY, |head| state.height_of(head));
        Self { root, head }
    }

    /// True when it has stood up for a gait with this fall height.
    #[must_use]
    pub fn has_risen(self, fall_height: f32) -> bool {
        self.root >= fall_height + RISEN_METRES && self.head >= self.root + HEAD_UP_METRES
    }
}

/// Root height below which a character at this position has fallen, metres; `None` where no height is a fall.
#[must_use]
pub fn fall_height(graph: &PolicyGraph, position: GraphPosition) -> Option<f32> {
    match position.as_node() {
        Some(node) => graph.node(node).fall_height,
        None => Some(graph.node(position.from).fall_height?.min(graph.node(position.to).fall_height?)),
    }
}

/// True when the root leans over far, where by its fall height a character stands as high as anywhere on the graph, or nearly so.
#[must_use]
pub(crate) fn lies(graph: &PolicyGraph, limit: Option<f32>, state: &CharacterState) -> bool {
    let upright = limit.is_some_and(|limit| limit >= UPRIGHT_SHARE * graph.greatest_fall_height());
    upright && (state.root().rotation * Vec3::Z).z < LYING_COSINE
}

/// Fall heights of a step along the graph, for [`FallDetector::holds_back`]: where it begins, and where it leads. An edge
/// that is only crossed ([`Edge::transit`](crate::training::Edge::transit)) leads to its end: a character that is to stand up
/// does so before it sets out.
#[must_use]
pub fn step_heights(graph: &PolicyGraph, [before, next]: [GraphPosition; 2]) -> [Option<f32>; 2] {
    let crossed = graph.edge_at(next).is_some_and(|edge| edge.transit);
    let leads_to = match before.along(next.from, next.to) {
        Some(t) if crossed && next.t < t => GraphPosition::node(next.from),
        Some(t) if crossed && next.t > t => GraphPosition::node(next.to),
        _ => next,
    };
    [before, leads_to].map(|position| fall_height(graph, position))
}

/// Watches one character for falls, and holds it back in a low gait until it has stood up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FallDetector {
    pub(crate) low_seconds: f32,
    pub(crate) rising_seconds: f32,
}

impl FallDetector {
    /// Forgets falls and rises.
    pub fn reset(&mut self) {
        *self = Self::default();
    }

    /// Takes one tick of the way from one position to the next, each by its [`fall_height`]. True when the step has to wait
    /// until the character has stood up.
    pub fn holds_back(&mut self, [from, to]: [Option<f32>; 2], heights: Heights, dt_secs: f32) -> bool {
        let rises = |to: f32| from.is_none_or(|from| from < to);
        let holds = to.is_some_and(|to| rises(to) && !heights.has_risen(to));
        self.rising_seconds = if holds { self.rising_seconds + dt_secs } else { 0.0 };
        holds
    }

    /// Seconds that the character has been held back.
    #[must_use]
    pub fn rising_seconds(&self) -> f32 {
        self.rising_seconds
    }

    /// True when the character is held back and should have stood up by now.
    #[must_use]
    pub fn is_late(&self) -> bool {
        self.rising_seconds > LATE_RISE_SECONDS
    }

    /// Position whose policies a character that is held back acts by: its own, and once it is late to and fro along the edge. A
    /// deterministic policy that rests half-way up stays there for good; another policy moves it on.
    #[must_use]
    pub fn acting_position(&self, position: GraphPosition) -> GraphPosition {
        if !self.is_late() || position.as_node().is_some() {
            return position;
        }
        let late = self.rising_seconds - LATE_RISE_SECONDS;
        let back = 0.5 * SWING * (1.0 - libm::cosf(core::f32::consts::TAU * late / SWING_SECONDS));
        let t = if position.t < 0.5 { position.t + back } else { position.t - back };
        GraphPosition { t: t.clamp(0.0, 1.0), ..position }
    }

    /// Takes the root's height above the ground, and whether it lies; true while the character has fallen.
    pub fn tick(&mut self, limit: Option<f32>, lies: bool, root_height: f32, dt_secs: f32) -> bool {
        let low = limit.is_some_and(|limit| root_height < limit);
        self.low_seconds = match (low, lies) {
            (true, _) => self.low_seconds + dt_secs,
            // In the same count: what lies is low for some time and then high.
            (false, true) => self.low_seconds + dt_secs * FALL_SECONDS / LYING_SECONDS,
            (false, false) => 0.0,
        };
        self.low_seconds >= FALL_SECONDS || self.rising_seconds >= RISE_SECONDS
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ids::NodeId;

    fn heights(root: f32, head: f32) -> Heights {
        Heights { root, head }
    }

    #[test]
    fn a_root_that_lies_on_something_high_is_a_fall() {
        let ticks = |lies: bool| {
            let mut fall = FallDetector::default();
            (1..100).find(|_| fall.tick(Some(0.5), lies, 0.6, 0.1))
        };
        assert!(ticks(true).is_some_and(|ticks| (15..=16).contains(&ticks)), "{:?}", ticks(true));
        assert_eq!(ticks(false), None);
        let mut fall = FallDetector::default();
        // It stumbles, and catches itself.
        assert!((0..60).all(|tick| !fall.tick(Some(0.5), tick % 20 < 12, 0.85, 0.1)));
    }

    #[test]
    fn a_late_rise_swings_along_the_edge_until_its_time_is_over() {
        let mut fall = FallDetector::default();
        let held = GraphPosition { from: NodeId::new(4), to: NodeId::new(5), t: 0.01 };
        let mut places = alloc::vec::Vec::new();
        let mut ticks = 0;
        while !fall.tick(None, false, 0.3, 0.1) {
            assert!(fall.holds_back([Some(0.2), Some(0.4)], heights(0.3, 0.7), 0.1));
            // Up to rounding: not at eight tenths, but at nine.
            assert!(ticks == 7 || fall.is_late() == (ticks > 7), "{ticks}");
            places.push(fall.acting_position(held).t);
            let other_way =
                fall.acting_position(GraphPosition { from: NodeId::new(5), to: NodeId::new(4), t: 0.99 });
            assert!((other_way.t + places[ticks] - 1.0).abs() < 1e-5, "{other_way:?} {places:?}");
            ticks += 1;
        }
        assert!((29..=31).contains(&ticks), "{ticks}");
        assert!(places[..7].iter().all(|t| *t == held.t), "{places:?}");
        let furthest = places.iter().copied().fold(0.0, f32::max);
        assert!(furthest > 0.55 && furthest < 0.62, "{furthest}");
        assert!(places[18] < 0.05, "up again after a run-up: {places:?}");
        let other_way =
            fall.acting_position(GraphPosition { from: NodeId::new(5), to: NodeId::new(4), t: 0.99 });
        assert!(other_way.t <= 0.99);
        assert!(!fall.holds_back([Some(0.4), Some(0.4)], heights(0.9, 1.4), 0.1));
        // Hips up and head down is no rise.
        assert!(fall.holds_back([None, Some(0.4)], heights(0.9, 1.0), 0.1));
        assert!(!fall.holds_back([None, Some(0.4)], heights(0.9, 1.2), 0.1));
        assert_eq!(fall.acting_position(held), held);
    }
}
