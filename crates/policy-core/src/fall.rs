//! Fall detection: a pelvis that stays lower than the policies in use allow. Who comes from where low is right has to be up
//! before it counts.

use crate::graph::{GraphPosition, PolicyGraph};

/// Seconds the pelvis must stay low.
const FALL_SECONDS: f32 = 0.3;

/// The pelvis has risen when it is this much higher than where it would have fallen, metres.
const RISEN_METRES: f32 = 0.1;

/// Seconds that a rise may take, out of where low is right, before it counts as a fall.
pub const RISE_SECONDS: f32 = 3.0;

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
        pelvis_height: f32,
        dt_secs: f32,
    ) -> bool {
        let holds =
            to.is_some_and(|to| from.is_none_or(|from| from < to) && pelvis_height < to + RISEN_METRES);
        self.rising_seconds = if holds { self.rising_seconds + dt_secs } else { 0.0 };
        holds
    }

    /// Takes the pelvis' height above the ground; true while the character has fallen.
    pub(crate) fn tick(&mut self, limit: Option<f32>, pelvis_height: f32, dt_secs: f32) -> bool {
        let low = limit.is_some_and(|limit| pelvis_height < limit);
        self.low_seconds = if low { self.low_seconds + dt_secs } else { 0.0 };
        self.low_seconds >= FALL_SECONDS || self.rising_seconds >= RISE_SECONDS
    }
}
