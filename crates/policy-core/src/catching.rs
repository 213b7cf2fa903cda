//! Catches: where a push drives a character that goes off its course, or beyond its speed, its gaits give all of their weight to their catching
//! variant for a moment.
//!
//! A gait that is pushed goes on putting one foot before the other. One policy that has learned to take over in the middle of a push steps
//! wherever the body needs a foot, and goes on towards the target meanwhile.

use glam::Vec2;

use crate::agility::{OnGraph, moving_mps};
use crate::skeleton::Skeleton;
use crate::state::CharacterState;
use crate::variants::Lasting;

/// A velocity that is further off than this plus this share of the speed asked for is that of a push, metres per second: aside, or ahead.
const PUSHED_MPS: f32 = 0.4;
const PUSHED_SHARE: f32 = 0.12;

/// On ground as uneven as this there is no catch; see [`Shares::rough_ground`](crate::variants::Shares::rough_ground).
const MOST_UNEVENNESS: f32 = 0.5;

/// A catch goes on for so long after the body was last as far off, seconds.
const SETTLES_SECS: f32 = 0.6;

/// Time from a gait to its catching variant, and back, seconds. The first is no longer than a tick.
const CROSS_SECS: [f32; 2] = [0.03, 0.2];

/// What decides whether a push is caught, beside what the body does.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Calm {
    /// See [`Urgency::at_pace`](crate::agility::Urgency::at_pace): before that a gait gathers speed, or brakes, by itself.
    pub(crate) at_pace: f32,
    /// Whether it turns: there a body leans, and its way is none that a push took it to.
    pub(crate) turns: bool,
    /// How uneven the ground is, in [0, 1]: a catching variant has learned level ground alone.
    pub(crate) unevenness: f32,
}

/// What a catch is after a tick of `dt` seconds. All gaits that act must have a catching variant.
pub(crate) fn next_catch(
    catch: Lasting,
    place: OnGraph<'_>,
    (skeleton, state): (&Skeleton, &CharacterState),
    target: Option<Vec2>,
    calm: Calm,
    dt: f32,
) -> Lasting {
    let can_catch = place.all_have(|node| node.catching) && !calm.turns && !place.crosses();
    let (Some(target), Some(speed), true) = (target, moving_mps(place.graph, place.position), can_catch)
    else {
        return Lasting::default();
    };
    let root = state.root();
    // A push on the trunk moves the head first, one on the hips the root.
    let head = skeleton.head().map_or(root.linear_velocity, |head| state.body(head).linear_velocity);
    let velocity = 0.5 * (root.linear_velocity + head).truncate();
    let way = (target - root.position.truncate()).normalize_or_zero();
    let acts_already = catch.share > 0.0;
    let variant = place.graph.node(place.position.nearest_node()).catching;
    let own_speed = variant.and_then(|variant| place.graph.node(variant).speed_mps);
    // The variant goes at a speed of its own: no push has given the body that.
    let pace = own_speed.map_or(speed, |own| speed.max(own));
    let most = PUSHED_MPS + PUSHED_SHARE * speed;
    let is_off = velocity.perp_dot(way).abs() > most || velocity.dot(way) - pace > most;
    let can_begin = calm.at_pace >= 1.0 && calm.unevenness < MOST_UNEVENNESS;
    catch.next(is_off && (can_begin || acts_already), SETTLES_SECS, CROSS_SECS, dt)
}
