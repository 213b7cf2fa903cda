//! Fall detection: a pelvis that stays lower than the policies in use allow. Who comes from where low is right has to be up
//! before it counts.

use crate::graph::{GraphPosition, PolicyGraph};

/// Seconds the pelvis must stay low.
const FALL_SECONDS: f32 = 0.3;

/// The pelvis has risen when it is this much higher than where it would have fallen, metres.
const RISEN_METRES: f32 = 0.1;

/// And the head is this much higher than the pelvis: who stoops head down on the way up is about to go down again.
const HEAD_UP_METRES: f32 = 0.2;

/// Seconds that a rise may take, out of where low is right, before it counts as a fall.
pub const RISE_SECONDS: f32 = 3.0;

/// Seconds after which a rise that has not come off is late: another skill takes over, or it takes a run-up.
const LATE_SECONDS: f32 = 0.8;

/// Seconds that a run-up lasts.
const RUN_UP_SECONDS: f32 = 1.1;

/// How far back along the edge a run-up goes.
const RUN_UP: f32 = 0.6;

/// Watches one character.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct FallDetector {
    low_seconds: f32,
    rising_seconds: f32,
}

/// Pelvis height below which a character at this place on the graph has fallen; `None` where low is right.
pub(crate) fn fall_height(graph: &PolicyGraph, position: GraphPosition) -> Option<f32> {
    let height = |node: usize| graph.nodes()[node].fall_height;
    match position.as_node() {
        Some(node) => height(node),
        None => Some(height(position.from)?.min(height(position.to)?)),
    }
}

impl FallDetector {
    pub(crate) fn reset(&mut self) {
        *self = Self::default();
    }

    /// True when the step from a place with one limit to a place with another has to wait until the character has risen.
    pub(crate) fn holds_back(
        &mut self,
        [from, to]: [Option<f32>; 2],
        [pelvis_height, head_height]: [f32; 2],
        dt_secs: f32,
    ) -> bool {
        let risen = |to| pelvis_height >= to + RISEN_METRES && head_height >= pelvis_height + HEAD_UP_METRES;
        let holds = to.is_some_and(|to| from.is_none_or(|from| from < to) && !risen(to));
        self.rising_seconds = if holds { self.rising_seconds + dt_secs } else { 0.0 };
        holds
    }

    /// True when the character is held back and should have risen by now.
    pub(crate) fn is_late(&self) -> bool {
        self.rising_seconds > LATE_SECONDS
    }

    /// Where on the graph a character acts that is held back at `position`: there, and after a while to and fro along the edge. A
    /// deterministic policy that has come to rest half-way up stays there for good; what moves it is another policy.
    pub(crate) fn place_to_act(&self, position: GraphPosition) -> GraphPosition {
        if !self.is_late() || position.as_node().is_some() {
            return position;
        }
        let late = self.rising_seconds - LATE_SECONDS;
        let back = 0.5 * RUN_UP * (1.0 - libm::cosf(core::f32::consts::TAU * late / RUN_UP_SECONDS));
        let t = if position.t < 0.5 { position.t + back } else { position.t - back };
        GraphPosition { t: t.clamp(0.0, 1.0), ..position }
    }

    /// Takes the pelvis' height above the ground; true while the character has fallen.
    pub(crate) fn tick(&mut self, limit: Option<f32>, pelvis_height: f32, dt_secs: f32) -> bool {
        let low = limit.is_some_and(|limit| pelvis_height < limit);
        self.low_seconds = if low { self.low_seconds + dt_secs } else { 0.0 };
        self.low_seconds >= FALL_SECONDS || self.rising_seconds >= RISE_SECONDS
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_late_rise_goes_back_and_comes_again_and_its_time_runs_on() {
        let mut fall = FallDetector::default();
        let held = GraphPosition { from: 4, to: 5, t: 0.01 };
        let mut places = alloc::vec::Vec::new();
        let mut ticks = 0;
        while !fall.tick(None, 0.3, 0.1) {
            assert!(fall.holds_back([Some(0.2), Some(0.4)], [0.3, 0.7], 0.1));
            // Up to rounding: not at eight tenths, but at nine.
            assert!(ticks == 7 || fall.is_late() == (ticks > 7), "{ticks}");
            places.push(fall.place_to_act(held).t);
            let other_way = fall.place_to_act(GraphPosition { from: 5, to: 4, t: 0.99 });
            assert!((other_way.t + places[ticks] - 1.0).abs() < 1e-5, "{other_way:?} {places:?}");
            ticks += 1;
        }
        assert!((29..=31).contains(&ticks), "{ticks}");
        assert!(places[..7].iter().all(|t| *t == held.t), "{places:?}");
        let furthest = places.iter().copied().fold(0.0, f32::max);
        assert!(furthest > 0.55 && furthest < 0.62, "{furthest}");
        assert!(places[18] < 0.05, "up again after a run-up: {places:?}");
        let other_way = fall.place_to_act(GraphPosition { from: 5, to: 4, t: 0.99 });
        assert!(other_way.t <= 0.99);
        assert!(!fall.holds_back([Some(0.4), Some(0.4)], [0.9, 1.4], 0.1));
        // Hips up and head down is no rise.
        assert!(fall.holds_back([None, Some(0.4)], [0.9, 1.0], 0.1));
        assert!(!fall.holds_back([None, Some(0.4)], [0.9, 1.2], 0.1));
        assert_eq!(fall.place_to_act(held), held);
    }
}
