//! What a character is asked to do during an episode: a target that is renewed, and a place on a course that moves.

use glam::Vec2;
use policy_core::{RISE_SECONDS, TARGET_RANGE_METRES};

use super::config::EnvironmentConfig;
use super::course::{Course, Place};
use super::fallen::FallRule;
use crate::Rng;

/// Seconds of a control tick.
pub const DT_SECS: f32 = 1.0 / 30.0;

/// Numbers of [`Command::intent_into`].
pub const INTENT_LEN: usize = 2;

/// Target and place on the course of one character.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Command {
    /// Where to go, world.
    pub target: Vec2,
    /// Where on the course it acts.
    pub place: Place,
    /// True when the target is to be reached and stood at.
    pub stop: bool,
    path: usize,
    coordinate: f32,
    /// Coordinate that is asked for; the present one follows as fast as the edges allow.
    asked: f32,
    /// Where the asked coordinate is going.
    goal: f32,
    /// Coordinate a tick; zero for one that rests.
    rate: f32,
    /// True for a coordinate that goes to and fro over the whole path.
    sweeps: bool,
    /// Ticks that a moving coordinate stays where it came to.
    rest_ticks: u32,
    /// Ticks that it has been held back, to rise first.
    rising_ticks: u32,
    target_ticks: u32,
    /// Direction of a stick held by a player, radians; `None` for targets fixed in the world.
    stick: Option<f32>,
}

impl Command {
    /// A command at the start of an episode, on a random path of the course, `at_node` or anywhere. [`Command::aim`] gives it
    /// a target.
    #[must_use]
    pub fn start(config: &EnvironmentConfig, course: &Course, at_node: bool, rng: &mut Rng) -> Self {
        let path = rng.index(course.paths());
        if config.alone {
            return Self::at(course, path, course.end(path));
        }
        let coordinate = if at_node { course.draw_node(path, rng) } else { course.draw(path, rng) };
        let mut command = Self::at(course, path, coordinate);
        // Half of the others move.
        let end = course.end(path);
        command.sweeps = end > 0.0 && !at_node && rng.chance(config.sweep);
        if command.sweeps {
            command.goal = if rng.chance(0.5) { end } else { 0.0 };
            command.rate = 2.0 * end * DT_SECS / rng.range(config.sweep_secs[0], config.sweep_secs[1]);
        } else if end > 0.0 && rng.chance(0.5) {
            command.go_elsewhere(config, course, rng);
        }
        command
    }

    /// A command at the start of an episode at one node, on a random path through it; in half of the cases to rest there.
    ///
    /// # Panics
    /// When the node is on no path.
    #[must_use]
    pub fn start_at(config: &EnvironmentConfig, course: &Course, node: usize, rng: &mut Rng) -> Self {
        let through = (0..course.paths()).filter(|path| course.path(*path).contains(&node));
        let path = through.clone().nth(rng.index(through.count())).expect("an index below the count");
        let coordinate = course.path(path).iter().position(|n| *n == node).expect("a path through it") as f32;
        let mut command = Self::at(course, path, coordinate);
        if rng.chance(0.5) {
            command.go_elsewhere(config, course, rng);
        }
        command
    }

    /// At rest at a coordinate of a path.
    fn at(course: &Course, path: usize, coordinate: f32) -> Self {
        let place = course.place(path, coordinate);
        Self { path, coordinate, asked: coordinate, goal: coordinate, place, ..Self::default() }
    }

    /// Lets the coordinate go to another one, and from there to others.
    fn go_elsewhere(&mut self, config: &EnvironmentConfig, course: &Course, rng: &mut Rng) {
        self.rate = DT_SECS / rng.range(config.edge_sweep_secs[0], config.edge_sweep_secs[1]);
        self.goal = course.draw(self.path, rng);
    }

    /// Sets the first target of an episode that starts at `position` with `heading`.
    pub fn aim(
        &mut self,
        config: &EnvironmentConfig,
        course: &Course,
        (position, heading): (Vec2, f32),
        rng: &mut Rng,
    ) {
        self.stick = rng.chance(config.stick).then_some(heading);
        self.renew_target(config, position, Some(heading), rng);
        self.follow_stick(course, position);
    }

    /// Writes what a critic is to know of where the coordinate is going: how far what is asked for and what it goes to lie
    /// from where it is.
    pub fn intent_into(&self, out: &mut [f32]) {
        let intent = [self.asked - self.coordinate, self.goal - self.coordinate];
        out.iter_mut().zip(intent).for_each(|(out, value)| *out = value);
    }

    /// True when it has been held back for longer than a rise may take.
    #[must_use]
    pub fn stuck(&self) -> bool {
        self.rising_ticks as f32 * DT_SECS >= RISE_SECONDS
    }

    /// True when it has been held back for longer than a rise at ease takes: what is asked for is not done.
    #[must_use]
    pub fn is_late(&self) -> bool {
        self.rising_ticks as f32 * DT_SECS >= EASY_RISE_SECONDS
    }

    /// Moves the command on by a tick. As in a game, the coordinate goes from where low is right to where it is not once the
    /// character has risen: once `low`, for the fall rule there, is false.
    pub fn advance(
        &mut self,
        config: &EnvironmentConfig,
        course: &Course,
        position: Vec2,
        low: impl FnOnce(FallRule) -> bool,
        rng: &mut Rng,
    ) {
        self.target_ticks = self.target_ticks.saturating_sub(1);
        if self.target_ticks == 0 {
            self.renew_target(config, position, None, rng);
        }
        if self.rate > 0.0 {
            self.asked += (self.goal - self.asked).clamp(-self.rate, self.rate);
            if self.sweeps && self.asked == self.goal {
                self.goal = if self.goal > 0.0 { 0.0 } else { course.end(self.path) };
            }
            self.rest_ticks = self.rest_ticks.saturating_sub(u32::from(self.asked == self.goal));
            if self.asked == self.goal && self.rest_ticks == 0 {
                let secs = rng.range(config.edge_rest_secs[0], config.edge_rest_secs[1]);
                self.rest_ticks = (secs / DT_SECS) as u32;
                self.goal = course.draw(self.path, rng);
                if rng.chance(config.jump) {
                    self.asked = self.goal;
                }
            }
        }
        let secs = course.edge_secs(self.place);
        let most = if secs > 0.0 { DT_SECS / secs } else { f32::INFINITY };
        let coordinate = self.coordinate + (self.asked - self.coordinate).clamp(-most, most);
        let place = course.place(self.path, coordinate);
        let [from, to] = [self.place, place].map(|place| course.fall(place));
        if from.rises_to(to) && low(to) {
            self.rising_ticks += 1;
        } else {
            (self.coordinate, self.place, self.rising_ticks) = (coordinate, place, 0);
        }
        self.follow_stick(course, position);
    }

    fn renew_target(
        &mut self,
        config: &EnvironmentConfig,
        position: Vec2,
        heading: Option<f32>,
        rng: &mut Rng,
    ) {
        let secs = rng.range(config.target_secs[0], config.target_secs[1]);
        self.target_ticks = (secs / DT_SECS).max(1.0) as u32;
        self.stop = rng.chance(config.stop);
        if let Some(direction) = &mut self.stick {
            // A player turns by up to a quarter; at a start from standing and now and then he wants to go anywhere.
            let anywhere = rng.chance(0.1);
            *direction = if anywhere { rng.angle() } else { *direction + rng.range(-1.0, 1.0) * QUARTER };
            return;
        }
        // Half of the first targets lie ahead, so that moving starts are not always asked to turn.
        let angle = match heading {
            Some(heading) if rng.chance(0.5) => heading + rng.range(-0.5, 0.5),
            _ => rng.angle(),
        };
        let distance =
            if self.stop { 0.0 } else { rng.range(config.target_metres[0], config.target_metres[1]) };
        self.target = position + distance * Vec2::from_angle(angle);
    }

    /// A stick's target goes ahead of the character; below the second node of a path that begins with standing it is as
    /// near as the stick is pushed little.
    fn follow_stick(&mut self, course: &Course, position: Vec2) {
        let Some(direction) = self.stick else { return };
        let begins_standing = course.nodes()[course.path(self.path)[0]].speed_mps == 0.0;
        let push = match (self.stop, begins_standing && course.end(self.path) > 0.0) {
            (true, _) => 0.0,
            (false, true) => self.asked.min(1.0),
            (false, false) => 1.0,
        };
        self.target = position + push * TARGET_RANGE_METRES * Vec2::from_angle(direction);
    }
}

/// Seconds that a rise takes at ease.
const EASY_RISE_SECONDS: f32 = 1.0;

const QUARTER: f32 = std::f32::consts::FRAC_PI_2;

#[cfg(test)]
#[path = "command_tests.rs"]
mod tests;
