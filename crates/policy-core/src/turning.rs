//! Turns: from the moment in which the target of a character that goes lies far aside until it goes there, its gaits give all of their weight to
//! their turning variant.
//!
//! Agile variants come in by how far the velocity is off, and each brakes and turns in its own way. One policy that has learned to go about out of
//! any gait is quicker, and leaves the rest to them.
//!
//! A gait that is slower than [`GOES_MPS`], such as a crawl, turns on the spot: it need not go before, and its turn ends by the heading alone. Its velocity
//! sways too much to tell where it goes.

use glam::Vec2;

use crate::agility::{OnGraph, moving_mps};
use crate::heading::Heading;
use crate::state::CharacterState;
use crate::variants::switched;

/// Angle off the heading at which a target begins a turn, radians.
const BEGINS_RADIANS: f32 = 0.55;

/// The way to the target has changed by at least this then, radians. Where it has not, a push has turned the body, and that is for others to
/// catch.
const CHANGED_RADIANS: f32 = 0.35;

/// Angle off the heading at which a gait that turns on the spot turns back to its target, radians: it has strayed.
const STRAYED_RADIANS: f32 = 1.2;

/// Angles off heading and course below which it ends, radians.
const FACES_RADIANS: f32 = 0.35;
const GOES_RADIANS: f32 = 0.2;

/// The first of these for a turn on the spot, which begins beyond it where the way has changed.
const FACES_ON_THE_SPOT_RADIANS: f32 = 0.2;

/// A character that is slower than this does not go; it sets off, metres per second. A gait that is slower turns on the spot.
pub(crate) const GOES_MPS: f32 = 0.4;

/// Below this speed a velocity has no direction, metres per second.
const DIRECTION_MPS: f32 = 0.2;

/// Time from a gait to its turning variant, and back, seconds. The first is no longer than a tick.
const CROSS_SECS: [f32; 2] = [0.03, 0.4];

/// What a turn remembers from tick to tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Turn {
    /// Whether it has begun and has not ended.
    pub(crate) turns: bool,
    /// How far the turning variant acts, in [0, 1].
    pub(crate) share: f32,
    /// The way to its target when it last faced it to within [`FACES_RADIANS`], world, of unit length; zero where it has not yet, since the last skill.
    pub(crate) way: Vec2,
}

impl Turn {
    /// What it is after a tick of `dt` seconds. In a start, and on an edge that is only crossed, there is none.
    pub(crate) fn next(
        self,
        starts: bool,
        place: OnGraph<'_>,
        state: &CharacterState,
        target: Option<Vec2>,
        dt: f32,
    ) -> Self {
        let can_turn = place.all_have(|node| node.turning)
            && moving_mps(place.graph, place.goal).is_some()
            && !starts
            && !place.crosses();
        let heading = Heading::from_rotation(state.root().rotation);
        let way = target.and_then(|target| (target - state.root().position.truncate()).try_normalize());
        let towards = way.map(|way| (way, heading.angle_off(way)));
        let on_the_spot = place.all_turn_on_the_spot();
        let turns = towards.is_some_and(|(way, off)| {
            can_turn
                && match on_the_spot {
                    true => self.turns_on_the_spot(way, off),
                    false => self.goes_about(state, way, off),
                }
        });
        let faced = towards.filter(|(_, off_heading)| *off_heading < FACES_RADIANS);
        Self {
            turns,
            share: switched(self.share, turns, CROSS_SECS, dt),
            way: faced.map_or(self.way, |(way, _)| way),
        }
    }

    /// Whether it is to turn to go this way, or still turns; `off_heading` is the angle from the heading to it, radians.
    fn goes_about(self, state: &CharacterState, way: Vec2, off_heading: f32) -> bool {
        let velocity = state.root().linear_velocity.truncate();
        let speed = libm::sqrtf(velocity.length_squared());
        match self.turns {
            true => {
                let off_course =
                    if speed > DIRECTION_MPS { libm::fabsf(velocity.angle_to(way)) } else { off_heading };
                off_heading > FACES_RADIANS || off_course > GOES_RADIANS
            }
            false => {
                let has_gone = self.way != Vec2::ZERO && speed > GOES_MPS;
                has_gone && self.has_changed(way) && off_heading > BEGINS_RADIANS
            }
        }
    }

    /// The same of a gait that turns on the spot. It turns until it faces a way that has changed. Its heading sways: where the way has not
    /// changed, it turns once it has strayed far.
    fn turns_on_the_spot(self, way: Vec2, off_heading: f32) -> bool {
        let asked = self.turns || self.has_changed(way);
        off_heading > if asked { FACES_ON_THE_SPOT_RADIANS } else { STRAYED_RADIANS }
    }

    /// Whether the way to the target is another one than when it last faced it.
    pub(crate) fn has_changed(self, way: Vec2) -> bool {
        libm::fabsf(self.way.angle_to(way)) > CHANGED_RADIANS
    }
}
