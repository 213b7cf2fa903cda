//! The tour: in the window, when there was no input for a while, a script moves the pad, or it follows the way over the course. Any input
//! ends it.

use gamepad::Script;
use glam::Vec2;
use playground::Follower;
use policy_core::{GamepadState, Heading};

use super::{App, ViewerCommand};
use crate::sim::SharedWorld;

/// Seconds without any input after which the tour begins.
pub const IDLE_SECS: f32 = 45.0;
/// That it begins is told so many seconds before.
const TOLD_SECS: f32 = 10.0;
/// Longest step that counts, seconds: a window that was moved or asleep was not idle.
const LONGEST_STEP: f32 = 0.25;
/// On the way to one point for longer, it begins anew, seconds.
const STUCK_SECS: f32 = 30.0;
/// It rests at the end of the way before it begins anew, seconds.
const REST_SECS: f32 = 4.0;

/// The camera stays where it is while it is within this of the character's heading, radians.
const LEAST_TURN: f32 = 0.35;
/// Furthest that the tour pushes the stick of the camera.
const MOST_STICK: f32 = 0.4;

/// The script of the tour.
const SCRIPT: &str = include_str!("../../../../assets/scripts/tour.ron");

/// Waits for its turn, and plays.
#[derive(Clone, Debug, Default)]
pub struct Tour {
    idle_secs: f32,
    playing: Option<Playing>,
}

/// What plays.
#[derive(Clone, Debug)]
enum Playing {
    /// Begins with the next tick.
    Due,
    /// A script, and how far it is, seconds.
    Script(Script, f64),
    /// Over the course: the pad of this tick, and for how long it rests at the end, seconds.
    Way { follower: Follower, pad: GamepadState, rested: f32 },
}

impl Tour {
    /// Somebody did something: the tour ends, or waits anew.
    pub fn interrupt(&mut self) {
        *self = Self::default();
    }

    /// Begins with the next tick.
    pub fn start(&mut self) {
        self.playing = Some(Playing::Due);
    }

    /// Lets `dt` seconds of the clock on the wall pass without any input. The tour begins after [`IDLE_SECS`] of them.
    pub fn advance(&mut self, dt: f32) {
        self.idle_secs += dt.clamp(0.0, LONGEST_STEP);
        if self.playing.is_none() && self.idle_secs > IDLE_SECS {
            self.start();
        }
    }

    /// Seconds until the tour begins, once they are few enough to be told; `None` before that and while it plays.
    #[must_use]
    pub fn begins_in(&self) -> Option<f32> {
        let left = IDLE_SECS - self.idle_secs;
        (self.playing.is_none() && left < TOLD_SECS).then_some(left.max(0.0))
    }

    /// Begins when it is due: over the course where there is a way, else by the script. True when it begins at the start of a way.
    fn begin(&mut self, shared: Option<&SharedWorld>) -> bool {
        if !matches!(self.playing, Some(Playing::Due)) {
            return false;
        }
        let has_way = shared.is_some_and(|shared| !shared.scene().way.is_empty());
        self.playing = if has_way {
            let (follower, pad) = (Follower::default(), GamepadState::default());
            Some(Playing::Way { follower, pad, rested: 0.0 })
        } else {
            Script::from_ron(SCRIPT).ok().map(|script| Playing::Script(script, 0.0))
        };
        has_way
    }

    /// Moves the pad for a tick of `dt_secs`. At its end it begins anew.
    fn tick(
        &mut self,
        (at, heading, camera): (Vec2, Heading, Heading),
        shared: Option<&SharedWorld>,
        dt_secs: f32,
    ) {
        match (&mut self.playing, shared) {
            (Some(Playing::Script(script, at)), _) => {
                *at += f64::from(dt_secs);
                if *at > script.duration() {
                    *at = 0.0;
                }
            }
            (Some(Playing::Way { follower, pad, rested }), Some(shared)) => {
                let view = (at, heading, camera);
                let moved = follower.tick(&shared.scene().way, view, |prop| shared.motion_of(prop), dt_secs);
                *rested += if moved.is_none() { dt_secs } else { 0.0 };
                *pad = moved.unwrap_or_default();
                pad.right_stick[0] = turn_of_camera(heading, camera);
                if follower.secs_on_the_way() > STUCK_SECS || *rested > REST_SECS {
                    self.playing = Some(Playing::Due);
                }
            }
            // The playground was left.
            (Some(Playing::Way { .. }), None) => self.interrupt(),
            (Some(Playing::Due) | None, _) => {}
        }
    }

    /// The pad, while it plays.
    #[must_use]
    pub fn pad(&self) -> Option<GamepadState> {
        Some(match self.playing.as_ref()? {
            Playing::Due => GamepadState::default(),
            Playing::Script(script, at) => script.state_at(*at),
            Playing::Way { pad, .. } => *pad,
        })
    }

    /// True while it plays.
    #[must_use]
    pub fn is_playing(&self) -> bool {
        self.playing.is_some()
    }
}

/// The right stick that brings a camera slowly behind a character that looks along `heading`.
fn turn_of_camera(heading: Heading, camera: Heading) -> f32 {
    let off = Heading::from_angle(heading.angle() - camera.angle()).angle();
    if off.abs() > LEAST_TURN { -(0.5 * off).clamp(-MOST_STICK, MOST_STICK) } else { 0.0 }
}

impl App {
    /// Lets the tour move its pad for the next tick. Over a course it begins at the start, with everything put back.
    pub(super) fn follow_tour(&mut self) {
        if self.tour.begin(self.sim.shared()) {
            self.apply(ViewerCommand::Reset);
        }
        let (player, camera) = (self.sim.player(), self.camera.heading());
        let view = (player.position(), player.heading(), camera);
        self.tour.tick(view, self.sim.shared(), self.sim.tick_secs());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tour by script that has waited for `secs` seconds.
    fn waited(secs: f32) -> Tour {
        let mut tour = Tour::default();
        (0..(secs * 10.0) as usize).for_each(|_| tour.advance(0.1));
        tour.begin(None);
        tour
    }

    fn tick(tour: &mut Tour) {
        tour.tick((Vec2::ZERO, Heading::FORWARD, Heading::FORWARD), None, 1.0 / 30.0);
    }

    #[test]
    fn it_begins_after_a_while_without_input_and_ends_with_the_first() {
        assert!(!waited(IDLE_SECS - 1.0).is_playing());
        let mut tour = waited(IDLE_SECS + 1.0);
        assert_eq!(tour.pad(), Some(GamepadState::default()));
        (0..150).for_each(|_| tick(&mut tour));
        assert!(tour.pad().unwrap().left_stick[1] > 0.9, "after five seconds it walks");
        tour.interrupt();
        assert_eq!(tour.pad(), None);
        tour.advance(0.1);
        assert!(!tour.is_playing(), "it waits as long as before");
    }

    #[test]
    fn it_is_told_before_it_begins_and_a_stall_is_not_idle() {
        assert_eq!(waited(IDLE_SECS - 11.0).begins_in(), None);
        let mut tour = waited(IDLE_SECS - 5.0);
        assert!((tour.begins_in().unwrap() - 5.0).abs() < 0.2, "{tour:?}");
        tour.advance(3600.0);
        assert!(!tour.is_playing());
        tour.interrupt();
        assert_eq!(tour.begins_in(), None);
        assert_eq!(waited(IDLE_SECS + 1.0).begins_in(), None, "it plays");
    }

    #[test]
    fn it_plays_round_and_round() {
        let mut tour = waited(IDLE_SECS + 1.0);
        let duration = Script::from_ron(SCRIPT).unwrap().duration();
        (0..(duration * 30.0) as usize + 5).for_each(|_| tick(&mut tour));
        assert!(tour.is_playing());
        assert_eq!(tour.pad(), Some(GamepadState::default()), "the first seconds are at rest");
    }

    #[test]
    fn the_camera_comes_behind_the_character() {
        for turned in [2.0, -2.0] {
            let mut camera = crate::camera::Camera::default();
            let heading = Heading::from_angle(camera.heading().angle() + turned);
            let off = |camera: &crate::camera::Camera| {
                camera.heading().direction().angle_to(heading.direction()).abs()
            };
            for _ in 0..240 {
                let stick = [turn_of_camera(heading, camera.heading()), 0.0];
                camera.advance(1.0 / 60.0, stick, glam::Vec3::ZERO, heading, 0.0);
            }
            assert!(off(&camera) < LEAST_TURN + 0.01, "{}", off(&camera));
        }
    }
}
