//! The way over the course, and a pad that follows it: for a tour of the scene, and to measure how a character fares on it.

use glam::Vec2;
use policy_core::contract::Motion;
use policy_core::{GamepadState, Heading};
use serde::Deserialize;

/// Right trigger of a jog.
const JOG: f32 = 0.4;
/// It jogs once it looks this much along its way: the cosine of the angle between them.
const LOOKS_ALONG: f32 = 0.8;
/// A pendulum nearer to the line of the way than this may hit what passes, metres.
const CLEAR_M: f32 = 1.6;

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
    /// Index of a prop that swings across the way: it is let past first.
    pub past: Option<usize>,
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
        self.sets_out |=
            waypoint.past.and_then(motion).is_none_or(|swinging| is_clear(&swinging, at, direction));
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

/// True when it is time to set out from `at` along `direction`: what swings across is about to turn back. It passes the way before a walker
/// is there, and once more after it has gone.
fn is_clear(swinging: &Motion, at: Vec2, direction: Vec2) -> bool {
    let aside = |v: Vec2| direction.perp_dot(v);
    let (place, speed) = (aside(swinging.position.truncate() - at), aside(swinging.velocity.truncate()));
    place.abs() > CLEAR_M && place * speed > 0.0
}

#[cfg(test)]
mod tests {
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
    fn it_waits_until_what_swings_has_passed() {
        let way = [Waypoint { past: Some(3), ..waypoint(6.0, 0.0) }];
        let view = (Vec2::ZERO, Heading::FORWARD, Heading::FORWARD);
        let mut follower = Follower::default();
        let mut push = |y: f32, mps: f32| {
            let motion = Motion::at(Vec3::new(3.0, y, 1.0)).moving(Vec3::Y * mps);
            let asked = |index: usize| (index == 3).then_some(motion);
            follower.tick(&way, view, asked, 0.1).unwrap().left_stick[1]
        };
        assert_eq!(push(0.5, 2.0), 0.0, "it is about to pass");
        assert_eq!(push(2.0, -1.0), 0.0, "it comes back");
        assert_eq!(push(-2.0, -0.5), 1.0, "it has passed");
        assert_eq!(push(-1.0, 2.0), 1.0, "on its way it goes on");
        assert!((follower.secs_on_the_way() - 0.4).abs() < 1e-6);
    }
}
