//! Starts and stops: while a character sets off from a stand its gaits give all of their weight to their starting variant, and while it comes
//! to a stand to their stopping variant.
//!
//! Both act at once, within a tick: they are over soon. A gait that turns well stands ready for anything and sets off late; a gait that is left
//! on its way down the graph goes on for as long as that takes.

use glam::Vec2;

use crate::agility::{OnGraph, moving_mps};
use crate::state::CharacterState;
use crate::variants::{Lasting, switched};

/// Time from a gait to its starting or stopping variant, and back, seconds. The first is no longer than a tick.
const CROSS_SECS: [f32; 2] = [0.03, 0.2];

/// A start takes at most so long, seconds.
const START_SECS: f32 = 1.0;

/// It has stood for so long before a start, in the measure of [`Urgency::at_rest`](crate::agility::Urgency::at_rest): 0.5 s. Out of a stop, or
/// right after a skill, nothing has learned to start.
const STOOD: f32 = 0.3;

/// A stop takes at most so long, seconds.
const STOP_SECS: f32 = 2.0;

/// A character that is faster than this goes, and may stop, metres per second.
const GOES_MPS: f32 = 0.4;

/// A character that is slower than this has nearly come to a stand: the stop ends so much later, seconds.
const STANDS_MPS: f32 = 0.3;
const STANDS_SECS: f32 = 0.1;

/// What a start is after a tick of `dt` seconds, of a character that has stood for so long. It ends once the character goes as fast towards its
/// target as the starting variant does. On the way to a gait that is slower than the variant there is none.
pub(crate) fn next_start(
    start: Lasting,
    at_rest: f32,
    place: OnGraph<'_>,
    state: &CharacterState,
    target: Option<Vec2>,
    dt: f32,
) -> Lasting {
    let root = state.root();
    let left = (start.secs - dt).max(0.0);
    let secs = match target {
        None if at_rest >= STOOD => START_SECS,
        None => left,
        Some(target) => {
            let speed = place.variant_mps(|node| node.starting);
            let along =
                root.linear_velocity.truncate().dot((target - root.position.truncate()).normalize_or_zero());
            let goes_on = |speed: f32| {
                along < speed && moving_mps(place.graph, place.goal).is_some_and(|asked| asked >= speed)
            };
            if speed.is_some_and(goes_on) { left } else { 0.0 }
        }
    };
    let acts = target.is_some() && secs > 0.0 && !place.crosses();
    Lasting { share: switched(start.share, acts, CROSS_SECS, dt), secs }
}

/// What a stop is after a tick of `dt` seconds. It begins in the tick in which a character that goes has no target any more and is to stand, and
/// ends once it is slow.
pub(crate) fn next_stop(
    stop: Lasting,
    place: OnGraph<'_>,
    state: &CharacterState,
    target: Option<Vec2>,
    dt: f32,
) -> Lasting {
    let can_stop = place.all_have(|node| node.stopping);
    let speed = state.horizontal_speed();
    let left = (stop.secs - dt).max(0.0);
    let secs = match target {
        _ if !can_stop => 0.0,
        Some(_) if speed > GOES_MPS => STOP_SECS,
        Some(_) => 0.0,
        None if speed < STANDS_MPS => left.min(STANDS_SECS),
        None => left,
    };
    let is_to_stand = target.is_none() && moving_mps(place.graph, place.goal).is_none();
    let acts = is_to_stand && secs > 0.0 && !place.crosses();
    Lasting { share: switched(stop.share, acts, CROSS_SECS, dt), secs }
}
