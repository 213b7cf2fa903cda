//! Slowing down to turn: a character that runs turns in a wide arc, one that walks turns on a few steps.

use glam::Vec2;

use crate::command::{Command, Goal};
use crate::graph::PolicyGraph;
use crate::heading::Heading;
use crate::state::CharacterState;

/// A target of a coordinate below this is moved away no further than one at it.
const LEAST_COORDINATE: f32 = 0.2;

/// While the target lies far off the heading, a path's coordinate moves towards the first gait of the path that moves.
/// Faster gaits slow down to it; a gait between standing and it speeds up, and an upright gait of another style gives way to
/// it. Low gaits beyond it, such as a crouch, stay, and so does one that strafes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TurnAssist {
    /// Angle from which it slows a faster gait down, radians.
    pub begin_radians: f32,
    /// Angle from which the coordinate of a faster gait is that gait's, radians; more than `begin_radians`.
    pub full_radians: f32,
    /// Angle from which it speeds a slower gait up, radians. A slow gait also ends a turn slowly.
    pub slow_begin_radians: f32,
    /// Angle from which the coordinate of a slower gait is that gait's, radians; more than `slow_begin_radians`.
    pub slow_full_radians: f32,
}

impl Default for TurnAssist {
    fn default() -> Self {
        Self { begin_radians: 0.5, full_radians: 1.0, slow_begin_radians: 0.15, slow_full_radians: 0.4 }
    }
}

impl TurnAssist {
    /// The command with coordinate and target adjusted. Goals that are no path's stay as they are.
    ///
    /// A slower gait that speeds up has its target moved away as much as its coordinate grows: what a stick pushed further asks
    /// for. A policy turns little for a target close by.
    #[must_use]
    pub fn adjusted(self, graph: &PolicyGraph, state: &CharacterState, command: &Command) -> Command {
        let (Goal::Path { path, coordinate }, Some(target)) = (command.goal, command.target) else {
            return *command;
        };
        let Some(nodes) = graph.paths().get(path.index()).map(|p| p.nodes()) else { return *command };
        let speed = |i: usize| graph.node(nodes[i]).speed_mps.unwrap_or(0.0);
        let Some(turning) = (0..nodes.len()).find(|&i| speed(i) > 0.0) else { return *command };
        let coordinate = coordinate.clamp(0.0, (nodes.len() - 1) as f32);
        let beyond = (libm::ceilf(coordinate) as usize).min(nodes.len() - 1);
        let fall_height = |i: usize| graph.node(nodes[i]).fall_height.unwrap_or(0.0);
        let low = fall_height(beyond) < fall_height(turning);
        if beyond > turning && (graph.node(nodes[beyond]).strafes || low && speed(beyond) < speed(turning)) {
            return *command;
        }
        let slower = coordinate < turning as f32;
        let (begin, full) = match slower {
            true => (self.slow_begin_radians, self.slow_full_radians),
            false => (self.begin_radians, self.full_radians),
        };
        let position = state.root().position.truncate();
        let to_target = target - position;
        let adjusted = coordinate + weight(state, to_target, [begin, full]) * (turning as f32 - coordinate);
        let further = if slower { (adjusted / coordinate.max(LEAST_COORDINATE)).max(1.0) } else { 1.0 };
        let goal = Goal::Path { path, coordinate: adjusted };
        Command { goal, target: Some(position + to_target * further), ..*command }
    }
}

/// How far it acts with a target at an angle off the heading, in [0, 1].
fn weight(state: &CharacterState, to_target: Vec2, [begin, full]: [f32; 2]) -> f32 {
    if to_target.length_squared() < 1e-6 {
        return 0.0;
    }
    let angle = Heading::from_rotation(state.root().rotation).angle_off(to_target);
    let weight = (angle - begin) / (full - begin);
    if weight.is_finite() { weight.clamp(0.0, 1.0) } else { 0.0 }
}
