//! The way over the course, and a pad that follows it: for a tour of the scene, and to measure how a character fares on it.

use std::f32::consts::PI;

use glam::Vec2;
use policy_core::contract::Motion;
use policy_core::{GamepadState, Heading};
use serde::Deserialize;

/// Right trigger of a jog.
const JOG: f32 = 0.4;
/// It jogs once it looks this much along its way: the cosine of the angle between them.
const LOOKS_ALONG: f32 = 0.8;
/// A walker sets off in this time, seconds, and then goes at this speed, metres per second.
const SETS_OFF_SECS: f32 = 0.35;
const WALK_MPS: f32 = 1.25;
/// It sets out when it comes to a pendulum at the turn of its swing, give or take this, radians of a whole swing of 2 pi.
const TURN_RADIANS: f32 = 0.12;

/// How a stretch of the way is taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
pub enum Pace {
    /// A full stick.
    #[default]
    Walk,
    /// The right trigger too, on a straight line.
    Jog,
    /// The left trigger: on hands and shins.
    Crawl,
}

/// A point of the way, and how it is reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waypoint {
    /// Metres.
    pub at: Vec2,
    /// It is reached within this distance, metres.
    pub near_m: f32,
    /// The pace towards it.
    pub pace: Pace,
    /// What swings across the way and is let past first.
    pub past: Option<Swinging>,
}

/// A prop that swings across a way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Swinging {
    /// Its index in the scene.
    pub prop: usize,
    /// How fast its phase turns, radians a second: 2 pi are one swing there and back.
    pub radps: f32,
}

/// Follows a way, waypoint after waypoint.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Follower {
    next: usize,
    sets_out: bool,
    secs: f32,
}

impl Follower {
    /// The pad of this tick of `dt_secs` for a character at `at` that looks along `heading`, seen from `camera`; `None` at the end
    /// of the way. `motion` has that of a prop, by its index in the scene.
    pub fn tick(
        &mut self,
        way: &[Waypoint],
        (at, heading, camera): (Vec2, Heading, Heading),
        motion: impl FnOnce(usize) -> Option<Motion>,
        dt_secs: f32,
    ) -> Option<GamepadState> {
        let next = way.get(self.next)?;
        if at.distance(next.at) < next.near_m {
            *self = Self { next: self.next + 1, ..Self::default() };
        }
        let waypoint = way.get(self.next)?;
        self.secs += dt_secs;
        let direction = (waypoint.at - at).normalize_or_zero();
        let swings = waypoint.past.and_then(|past| Some((motion(past.prop)?, past.radps)));
        self.sets_out |=
            swings.is_none_or(|(motion, radps)| comes_at_the_turn(&motion, radps, at, direction));
        let jogs = waypoint.pace == Pace::Jog && direction.dot(heading.direction()) > LOOKS_ALONG;
        let push = if self.sets_out { camera.heading_from_world_2d(direction) } else { Vec2::ZERO };
        Some(GamepadState {
            // Forward and left in the heading's frame; right and up on the stick.
            left_stick: [-push.y, push.x],
            right_trigger: if jogs { JOG } else { 0.0 },
            left_trigger: if waypoint.pace == Pace::Crawl { 1.0 } else { 0.0 },
            ..GamepadState::default()
        })
    }

    /// How long it has been on its way to the next waypoint, seconds: after long it is stuck.
    #[must_use]
    pub fn secs_on_the_way(&self) -> f32 {
        self.secs
    }
}

/// True when it is time to set out from `at` along `direction`: what swings across is at the turn of its swing, far aside, when the walker
/// comes to it.
fn comes_at_the_turn(swinging: &Motion, radps: f32, at: Vec2, direction: Vec2) -> bool {
    let off = swinging.position.truncate() - at;
    let secs = SETS_OFF_SECS + direction.dot(off) / WALK_MPS;
    // The place aside is the cosine of the phase, so it turns at every multiple of pi.
    let (place, speed) = (direction.perp_dot(off), direction.perp_dot(swinging.velocity.truncate()));
    let phase = (-speed / radps).atan2(place) + radps * secs;
    (phase / PI - (phase / PI).round()).abs() * PI < TURN_RADIANS
}

#[cfg(test)]
mod tests {
    use std::f32::consts::TAU;

    use glam::Vec3;

    use super::*;

    fn waypoint(x: f32, y: f32) -> Waypoint {
        Waypoint { at: Vec2::new(x, y), near_m: 0.5, pace: Pace::Walk, past: None }
    }

    #[test]
    fn the_stick_points_along_the_way_from_any_camera() {
        let way = [waypoint(4.0, 0.0)];
        let stick = |camera: f32| {
            let view = (Vec2::ZERO, Heading::FORWARD, Heading::from_angle(camera));
            Follower::default().tick(&way, view, |_| None, 0.1).unwrap().left_stick
        };
        let near = |a: [f32; 2], b: [f32; 2]| Vec2::from(a).distance(b.into()) < 1e-6;
        assert!(near(stick(0.0), [0.0, 1.0]), "away from the camera");
        assert!(
            near(stick(std::f32::consts::FRAC_PI_2), [1.0, 0.0]),
            "to the right of one that looks to the left"
        );
    }

    #[test]
    fn it_passes_waypoint_after_waypoint_and_jogs_where_it_looks_along() {
        let way = [waypoint(2.0, 0.0), Waypoint { pace: Pace::Jog, ..waypoint(2.0, 6.0) }];
        let (mut follower, mut at, mut heading) = (Follower::default(), Vec2::ZERO, Heading::FORWARD);
        let mut triggers = Vec::new();
        while let Some(pad) = follower.tick(&way, (at, heading, Heading::FORWARD), |_| None, 0.1) {
            triggers.push((at, pad.right_trigger));
            let [x, y] = pad.left_stick;
            at += Vec2::new(y, -x) * 0.1;
            heading = Heading::from_direction(Vec2::new(y, -x));
            assert!(triggers.len() < 200, "stuck at {at}");
        }
        assert!(at.distance(way[1].at) < 0.6);
        assert!(triggers.iter().any(|(at, trigger)| *trigger > 0.0 && at.y > 1.0));
        assert!(triggers.iter().all(|(at, trigger)| *trigger == 0.0 || at.x > 1.4), "the corner is walked");
    }

    #[test]
    fn it_waits_until_it_comes_to_what_swings_at_the_turn_of_its_swing() {
        // From a stand, two metres and a half before a pendulum of three seconds that swings 1.5 m to either side.
        let (radps, reach, plane) = (TAU / 3.0, 1.5, 2.5);
        let way = [Waypoint { past: Some(Swinging { prop: 3, radps }), ..waypoint(6.0, 0.0) }];
        let view = (Vec2::ZERO, Heading::FORWARD, Heading::FORWARD);
        let comes_after = SETS_OFF_SECS + plane / WALK_MPS;
        for start in [0.0, 0.7, 1.9, 2.8] {
            let mut follower = Follower::default();
            let swing = |secs: f32| (radps * secs).sin_cos();
            let sets_out = (0..300).map(|tick| start + 0.01 * tick as f32).find(|secs| {
                let (sin, cos) = swing(*secs);
                let motion =
                    Motion::at(Vec3::new(plane, reach * cos, 1.0)).moving(-reach * radps * sin * Vec3::Y);
                let asked = |index: usize| (index == 3).then_some(motion);
                follower.tick(&way, view, asked, 0.01).unwrap().left_stick[1] > 0.0
            });
            let there = swing(sets_out.expect("it sets out within a swing") + comes_after).1;
            assert!(there.abs() > 0.99, "it comes to it {there} of its reach aside");
        }
    }

    #[test]
    fn once_it_has_set_out_it_goes_on() {
        let way = [Waypoint { past: Some(Swinging { prop: 0, radps: 2.0 }), ..waypoint(6.0, 0.0) }];
        let mut follower = Follower::default();
        let view = (Vec2::ZERO, Heading::FORWARD, Heading::FORWARD);
        let mut push =
            |motion: Option<Motion>| follower.tick(&way, view, |_| motion, 0.1).unwrap().left_stick[1];
        let aside = Motion::at(Vec3::new(0.0, 1.0, 1.0));
        assert_eq!(
            push(Some(aside)),
            0.0,
            "it is at the turn of its swing now, and not once the walker is there"
        );
        assert_eq!(push(None), 1.0, "it is gone");
        assert_eq!(push(Some(aside)), 1.0);
    }
}
