//! Catches: where a push drives a character that goes off its course, beyond its speed, or a fast one far below it, its gaits give all of their
//! weight to their catching variant for a moment. So they do where it goes on out of a skill, until it has settled.
//!
//! A gait that is pushed goes on putting one foot before the other. One policy that has learned to take over in the middle of a push steps
//! wherever the body needs a foot, and goes on towards the target meanwhile.

use glam::Vec2;

use crate::agility::{OnGraph, Urgency, moving_mps};
use crate::balance::trunk_velocity;
use crate::skeleton::Skeleton;
use crate::state::CharacterState;
use crate::variants::Lasting;

/// A velocity that is further off than this plus this share of the speed asked for is that of a push, metres per second: aside, or ahead. A gait that
/// is asked to be faster than the variant is pushed back where it is so much slower than the variant.
const PUSHED_MPS: f32 = 0.4;
const PUSHED_SHARE: f32 = 0.12;

/// On ground as uneven as this there is no catch; see [`Shares::rough_ground`](crate::variants::Shares::rough_ground).
const MOST_UNEVENNESS: f32 = 0.5;

/// A catch goes on for so long after the body was last as far off, seconds.
const SETTLES_SECS: f32 = 0.6;

/// Time from a gait to its catching variant, and back, seconds. The first is no longer than a tick.
const CROSS_SECS: [f32; 2] = [0.03, 0.2];

/// A catch, or one that lasts until a character has settled after a skill: it is not in balance yet where it goes on.
pub(crate) fn out_of_skill(catch: Lasting, settle_secs: f32, unevenness: f32) -> Lasting {
    match settle_secs > 0.0 && unevenness < MOST_UNEVENNESS {
        true => Lasting { share: 1.0, secs: settle_secs },
        false => catch,
    }
}

/// What a catch is after a tick of `dt` seconds. All gaits that act must have a catching variant, which has learned level ground alone: `unevenness`
/// is that of the ground, in [0, 1]. In a turn a body leans, and before it goes at its pace it gathers speed, or brakes, by itself.
pub(crate) fn next_catch(
    catch: Lasting,
    place: OnGraph<'_>,
    (skeleton, state): (&Skeleton, &CharacterState),
    target: Option<Vec2>,
    urgency: &Urgency,
    unevenness: f32,
    dt: f32,
) -> Lasting {
    let can_catch = place.all_have(|node| node.catching) && !urgency.turn.turns && !place.crosses();
    let (Some(target), Some(speed), true) = (target, moving_mps(place.graph, place.position), can_catch)
    else {
        return Lasting::default();
    };
    let velocity = trunk_velocity(skeleton, state).truncate();
    let way = (target - state.root().position.truncate()).normalize_or_zero();
    // The variant goes at a speed of its own: no push has given the body that.
    let own = place.variant_mps(|node| node.catching).unwrap_or(speed);
    let (along, most) = (velocity.dot(way), PUSHED_MPS + PUSHED_SHARE * speed);
    let held_back = speed > own && own - along > most;
    let is_off = velocity.perp_dot(way).abs() > most || along - speed.max(own) > most || held_back;
    let acts_already = catch.share > 0.0;
    // A gait without a turning variant turns by itself, and its body leans then too.
    let goes_on = urgency.at_pace >= 1.0 && !urgency.turn.has_changed(way);
    let can_begin = goes_on && unevenness < MOST_UNEVENNESS;
    catch.next(is_off && (can_begin || acts_already), SETTLES_SECS, CROSS_SECS, dt)
}
