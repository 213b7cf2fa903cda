//! What a character is told to do during an episode: a target that is renewed, and a position on the graph that moves.

use glam::Vec2;
use physics_bridge::CONTROL_HZ;
use policy_core::training::{FallDetector, Heights, RISE_SECONDS, SteeringState, step_heights};
use policy_core::{CharacterState, GraphPosition, NodeId, PathId};
use random::Rng;

use super::graph::TrainingGraph;

mod config;
mod facing;
mod stick;

pub use config::{CommandConfig, StrafeConfig};
use facing::Facing;

/// Seconds of a control tick.
pub const DT_SECS: f32 = 1.0 / CONTROL_HZ as f32;

/// Numbers of [`Command::intent_into`].
pub const INTENT_LEN: usize = 2;

/// Gaits below this speed stop by their target, metres per second.
const SLOW_MPS: f32 = 0.6;

/// Gaits above this speed keep their targets longer, metres per second.
const FAST_MPS: f32 = 2.0;

/// Seconds of a sweep to the end of a path and back, least and most.
const SWEEP_SECS: [f32; 2] = [4.0, 8.0];

/// Target and position on the graph of one character.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Command {
    /// Where to go, world.
    pub target: Vec2,
    /// Where the policy sees the target, world: corrected by steering when it is assisted.
    pub seen_target: Vec2,
    /// Where on the graph it acts.
    pub position: GraphPosition,
    /// True when the target is to be reached and stood at.
    pub stop: bool,
    path: PathId,
    coordinate: f32,
    /// Requested coordinate; the present one follows as fast as the edges allow.
    asked: f32,
    /// Where the requested coordinate is going.
    goal: f32,
    /// Coordinate a tick; zero for one that rests.
    rate: f32,
    /// True for a coordinate that goes to and fro over the whole path.
    sweeps: bool,
    /// Ticks that a moving coordinate stays where it arrived.
    rest_ticks: u32,
    /// Holds it back in a low gait until the character stands.
    fall: FallDetector,
    target_ticks: u32,
    /// Direction of a stick held by a player, radians, from the way to face where there is one; `None` for targets fixed in the
    /// world.
    stick: Option<f32>,
    /// True for a stick that goes through turn assist and steering, as in a game.
    assisted: bool,
    /// True for a stick whose release leads back to standing along the path.
    leads_to_standing: bool,
    steering: SteeringState,
    /// Where it is to face, beside where it goes; `None` for a target that it faces.
    facing: Option<Facing>,
}

impl Default for Command {
    /// Nowhere to go, at the first node.
    fn default() -> Self {
        let (path, node) = (PathId::new(0), NodeId::new(0));
        Self::resting(path, 0.0, GraphPosition::node(node))
    }
}

impl Command {
    /// A command at the start of an episode, on a random path of the graph, `at_node` or anywhere. [`Command::aim`] gives it
    /// a target.
    #[must_use]
    pub fn start(config: &CommandConfig, graph: &TrainingGraph, at_node: bool, rng: &mut Rng) -> Self {
        let path = graph.sample_path(rng);
        if config.stay_at_end {
            return Self::at(graph, path, graph.end(path));
        }
        let coordinate = if at_node { graph.sample_node(path, rng) } else { graph.sample(path, rng) };
        let mut command = Self::at(graph, path, coordinate);
        // Half of the others move.
        let end = graph.end(path);
        command.sweeps = end > 0.0 && !at_node && rng.chance(config.sweep_share);
        if command.sweeps {
            command.goal = if rng.chance(0.5) { end } else { 0.0 };
            command.rate = 2.0 * end * DT_SECS / rng.range(SWEEP_SECS[0], SWEEP_SECS[1]);
        } else if end > 0.0 && rng.chance(0.5) {
            command.go_elsewhere(config, graph, rng);
        }
        command
    }

    /// A command at the start of an episode at one node, on a random path through it; in half of the cases to rest there.
    ///
    /// # Panics
    /// When the node is on no path.
    #[must_use]
    pub fn start_at(config: &CommandConfig, graph: &TrainingGraph, node: usize, rng: &mut Rng) -> Self {
        let coordinates = graph.paths().iter().enumerate().filter_map(|(index, path)| {
            Some((PathId::new(index), path.coordinate(GraphPosition::node(NodeId::new(node)))?))
        });
        let through = rng.index(coordinates.clone().count());
        let (path, coordinate) = coordinates.clone().nth(through).expect("an index below the count");
        let mut command = Self::at(graph, path, coordinate);
        if rng.chance(0.5) {
            command.go_elsewhere(config, graph, rng);
        }
        command
    }

    /// At rest at a coordinate of a path.
    pub(super) fn at(graph: &TrainingGraph, path: PathId, coordinate: f32) -> Self {
        Self::resting(path, coordinate, graph.position(path, coordinate))
    }

    fn resting(path: PathId, coordinate: f32, position: GraphPosition) -> Self {
        Self {
            target: Vec2::ZERO,
            seen_target: Vec2::ZERO,
            position,
            stop: false,
            path,
            coordinate,
            asked: coordinate,
            goal: coordinate,
            rate: 0.0,
            sweeps: false,
            rest_ticks: 0,
            fall: FallDetector::default(),
            target_ticks: 0,
            stick: None,
            assisted: false,
            leads_to_standing: false,
            steering: SteeringState::default(),
            facing: None,
        }
    }

    /// Lets the coordinate go to another one, and from there to others.
    fn go_elsewhere(&mut self, config: &CommandConfig, graph: &TrainingGraph, rng: &mut Rng) {
        self.rate = DT_SECS / rng.range(config.edge_sweep_secs[0], config.edge_sweep_secs[1]);
        self.goal = graph.sample(self.path, rng);
    }

    /// Sets the first target of an episode that starts at `position` with `heading`.
    pub fn aim(
        &mut self,
        config: &CommandConfig,
        graph: &TrainingGraph,
        (position, heading): (Vec2, f32),
        rng: &mut Rng,
    ) {
        self.stick =
            rng.chance(config.stick_share).then_some(if config.strafe.is_some() { 0.0 } else { heading });
        self.assisted = self.stick.is_some() && rng.chance(config.assisted_share);
        self.facing = config.strafe.map(|_| Facing::along(heading));
        self.renew_target(config, graph, (position, Some(heading)), rng);
        self.follow_stick(graph, position);
        self.seen_target = self.target;
    }

    /// Writes where the coordinate is going, for the critic: distances to the requested coordinate and to the goal.
    pub fn intent_into(&self, out: &mut [f32]) {
        let asked = if self.is_released() { 0.0 } else { self.asked };
        let intent = [asked - self.coordinate, self.goal - self.coordinate];
        out.iter_mut().zip(intent).for_each(|(out, value)| *out = value);
    }

    /// True when it has been held back for longer than standing up may take.
    #[must_use]
    pub fn stuck(&self) -> bool {
        self.fall.rising_seconds() >= RISE_SECONDS
    }

    /// True when it is held back and the character should have stood up by now: the command is not followed.
    #[must_use]
    pub fn is_late(&self) -> bool {
        self.fall.is_late()
    }

    /// Advances by a tick, by the game's rules: the position crosses edges no faster than their seconds, and leaving a low gait
    /// requires standing first.
    pub fn advance(
        &mut self,
        config: &CommandConfig,
        graph: &TrainingGraph,
        state: &CharacterState,
        heights: Heights,
        rng: &mut Rng,
    ) {
        let root = state.root().position.truncate();
        self.target_ticks = self.target_ticks.saturating_sub(1);
        if self.target_ticks == 0 {
            self.renew_target(config, graph, (root, None), rng);
        }
        if self.rate > 0.0 {
            self.asked += (self.goal - self.asked).clamp(-self.rate, self.rate);
            if self.sweeps && self.asked == self.goal {
                self.goal = if self.goal > 0.0 { 0.0 } else { graph.end(self.path) };
            }
            self.rest_ticks = self.rest_ticks.saturating_sub(u32::from(self.asked == self.goal));
            if self.asked == self.goal && self.rest_ticks == 0 {
                let secs = rng.range(config.edge_rest_secs[0], config.edge_rest_secs[1]);
                self.rest_ticks = (secs / DT_SECS) as u32;
                self.goal = graph.sample(self.path, rng);
                if rng.chance(config.jump_share) {
                    self.asked = self.goal;
                }
            }
        }
        if let (Some(facing), Some(strafe)) = (&mut self.facing, &config.strafe) {
            facing.advance(strafe, rng);
        }
        self.follow_stick(graph, root);
        let (rules, mut next) = (graph.policy_graph(), self.position);
        rules.travel(&mut next, graph.position(self.path, self.assist(graph, state)), DT_SECS);
        let limits = step_heights(rules, [self.position, next]);
        if !self.fall.holds_back(limits, heights, DT_SECS) {
            self.position = next;
            let coordinate = graph.paths().get(self.path.index()).and_then(|path| path.coordinate(next));
            self.coordinate = coordinate.unwrap_or(self.coordinate);
        }
    }

    fn renew_target(
        &mut self,
        config: &CommandConfig,
        graph: &TrainingGraph,
        (position, heading): (Vec2, Option<f32>),
        rng: &mut Rng,
    ) {
        let speed = graph.speed_mps(self.position);
        let factor = if speed > FAST_MPS { config.fast_target_factor } else { 1.0 };
        let secs = factor * rng.range(config.target_secs[0], config.target_secs[1]);
        self.target_ticks = (secs / DT_SECS).max(1.0) as u32;
        let slow = speed > 0.0 && speed < SLOW_MPS;
        let of_slow = config.slow_stop_share.filter(|_| slow);
        self.stop = rng.chance(of_slow.unwrap_or(config.stop_share));
        self.leads_to_standing = !slow && graph.begins_standing(self.path);
        if let Some(direction) = &mut self.stick {
            // A player mostly turns by up to a quarter, and in a hurry by any angle.
            let anywhere = rng.chance(config.any_direction_share);
            *direction = match self.facing {
                Some(_) => facing::way_to_go(config.strafe.unwrap_or_default().max_angle, anywhere, rng),
                _ if anywhere => rng.angle(),
                _ => *direction + rng.range(-1.0, 1.0) * QUARTER,
            };
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
}

const QUARTER: f32 = std::f32::consts::FRAC_PI_2;

#[cfg(test)]
#[path = "command_tests.rs"]
mod tests;
