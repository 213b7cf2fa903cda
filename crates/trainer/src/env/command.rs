//! What a character is asked to do during an episode: a target that is renewed, and a place on a course that moves.

use glam::Vec2;
use policy_core::TARGET_RANGE_METRES;

use super::config::EnvironmentConfig;
use super::course::{Course, Place};
use crate::Rng;

/// Seconds of a control tick.
pub const DT_SECS: f32 = 1.0 / 30.0;

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
    target_ticks: u32,
    /// Direction of a stick held by a player, radians; `None` for targets fixed in the world.
    stick: Option<f32>,
}

impl Command {
    /// A command at the start of an episode, on a random path of the course. [`Command::aim`] gives it a target.
    #[must_use]
    pub fn start(config: &EnvironmentConfig, course: &Course, rng: &mut Rng) -> Self {
        let path = rng.index(course.paths());
        let coordinate = course.draw(path, rng);
        let place = course.place(path, coordinate);
        let mut command =
            Self { path, coordinate, asked: coordinate, goal: coordinate, place, ..Self::default() };
        // Half of the others move.
        let end = course.end(path);
        command.sweeps = end > 0.0 && rng.chance(config.sweep);
        if command.sweeps {
            command.goal = if rng.chance(0.5) { end } else { 0.0 };
            command.rate = 2.0 * end * DT_SECS / rng.range(config.sweep_secs[0], config.sweep_secs[1]);
        } else if end > 0.0 && rng.chance(0.5) {
            command.rate = DT_SECS / rng.range(config.edge_sweep_secs[0], config.edge_sweep_secs[1]);
            command.goal = course.draw(path, rng);
        }
        command
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

    /// Moves the command on by a tick.
    pub fn advance(&mut self, config: &EnvironmentConfig, course: &Course, position: Vec2, rng: &mut Rng) {
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
        self.coordinate += (self.asked - self.coordinate).clamp(-most, most);
        self.place = course.place(self.path, self.coordinate);
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

const QUARTER: f32 = std::f32::consts::FRAC_PI_2;

#[cfg(test)]
mod tests {
    use super::super::course::CourseNode;
    use super::*;

    fn edge() -> Course {
        let node = |name: &str, speed_mps, share| {
            let config = EnvironmentConfig { speed_mps, ..EnvironmentConfig::default() };
            CourseNode::new(name, &config, share)
        };
        Course::new(vec![node("walk", 1.25, 0.3), node("idle", 0.0, 0.7)], vec![vec![0, 1]])
    }

    #[test]
    fn on_a_single_node_the_blend_stays() {
        let config = EnvironmentConfig::default();
        let course = Course::new(edge().nodes().to_vec(), vec![vec![1]]);
        let mut rng = Rng::new(1, 1);
        let mut command = Command::start(&config, &course, &mut rng);
        command.aim(&config, &course, (Vec2::ZERO, 0.0), &mut rng);
        for _ in 0..1000 {
            command.advance(&config, &course, Vec2::ZERO, &mut rng);
            assert_eq!(command.place, Place { edge: 0, t: 1.0 });
        }
    }

    #[test]
    fn blends_and_targets_stay_in_range_and_are_renewed() {
        let (config, course, mut rng) = (EnvironmentConfig::default(), edge(), Rng::new(2, 1));
        let (mut at_child, mut targets, mut count) = (0, 0, 0);
        for _ in 0..200 {
            let mut command = Command::start(&config, &course, &mut rng);
            command.aim(&config, &course, (Vec2::ONE, 0.0), &mut rng);
            for _ in 0..150 {
                let before = command.target;
                command.advance(&config, &course, Vec2::ONE, &mut rng);
                assert!((0.0..=1.0).contains(&command.place.t));
                assert!(command.target.distance(Vec2::ONE) <= 10.001);
                targets += usize::from(command.target != before);
                at_child += usize::from(command.place.t == 1.0);
                count += 1;
            }
        }
        assert!(targets > 100 && (0.2..0.5).contains(&(at_child as f32 / count as f32)));
    }

    #[test]
    fn a_moving_coordinate_rests_where_it_came_to() {
        let config = EnvironmentConfig {
            edge_sweep_secs: [0.1, 0.1],
            edge_rest_secs: [2.0, 2.0],
            jump: 0.0,
            ..Default::default()
        };
        let (course, mut rng) = (edge(), Rng::new(4, 1));
        let (mut rests, mut moves) = (0, 0);
        for _ in 0..50 {
            let mut command = Command::start(&config, &course, &mut rng);
            command.aim(&config, &course, (Vec2::ZERO, 0.0), &mut rng);
            let mut still = 60;
            for _ in 0..300 {
                let before = command.place.t;
                command.advance(&config, &course, Vec2::ZERO, &mut rng);
                if command.place.t == before {
                    still += 1;
                } else {
                    moves += 1;
                    // Either on its way, a tenth of a second at most, or after a rest of two seconds.
                    assert!(still == 0 || still >= 58, "{still}");
                    rests += usize::from(still > 0);
                    still = 0;
                }
            }
        }
        assert!(rests > 50 && moves > rests, "{rests} {moves}");
    }

    #[test]
    fn a_sweep_goes_to_both_ends_and_does_not_rest() {
        let config = EnvironmentConfig { sweep: 1.0, sweep_secs: [4.0, 4.0], ..EnvironmentConfig::default() };
        let (course, mut rng) = (edge(), Rng::new(5, 1));
        for _ in 0..20 {
            let mut command = Command::start(&config, &course, &mut rng);
            command.aim(&config, &course, (Vec2::ZERO, 0.0), &mut rng);
            let (mut ends, mut still) = ([false; 2], 0);
            for _ in 0..130 {
                let before = command.place.t;
                command.advance(&config, &course, Vec2::ZERO, &mut rng);
                ends = [ends[0] || command.place.t == 0.0, ends[1] || command.place.t == 1.0];
                still += usize::from(command.place.t == before);
            }
            assert!(ends == [true; 2] && still <= 4, "{ends:?} {still}");
        }
    }

    #[test]
    fn the_place_follows_what_is_asked_no_faster_than_an_edge_allows() {
        let config =
            EnvironmentConfig { edge_secs: 1.0, jump: 1.0, stick: 1.0, ..EnvironmentConfig::default() };
        let nodes = [("walk", 1.25), ("idle", 0.0)].map(|(name, speed_mps)| {
            CourseNode::new(name, &EnvironmentConfig { speed_mps, ..config.clone() }, 1.0)
        });
        let (course, mut rng) = (Course::new(nodes.to_vec(), vec![vec![0, 1]]), Rng::new(3, 1));
        let mut moved = 0.0;
        for _ in 0..50 {
            let mut command = Command::start(&config, &course, &mut rng);
            command.aim(&config, &course, (Vec2::ZERO, 0.0), &mut rng);
            for tick in 0..300 {
                let (before, position) = (command.place.t, Vec2::splat(tick as f32));
                command.advance(&config, &course, position, &mut rng);
                let step = (command.place.t - before).abs();
                assert!(step <= DT_SECS + 1e-6, "{step}");
                moved += step;
                let away = command.target.distance(position);
                assert!(away < 1e-3 || (away - TARGET_RANGE_METRES).abs() < 1e-3, "{away}");
            }
        }
        assert!(moved > 50.0, "{moved}");
    }
}
