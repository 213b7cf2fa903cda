//! Slowing down to turn: a character that runs turns in a wide arc, one that walks turns on a few steps.

use crate::command::{Command, Goal};
use crate::graph::PolicyGraph;
use crate::heading::Heading;
use crate::state::CharacterState;

/// While the target lies far off the heading, a path's coordinate moves towards the first gait of the path that moves.
/// Faster gaits slow down to it; a gait between standing and it speeds up. Slower gaits beyond it, such as a crouch, stay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TurnAssist {
    /// Angle from which it acts, radians.
    pub begin_radians: f32,
    /// Angle from which the coordinate is that gait's, radians; more than `begin_radians`.
    pub full_radians: f32,
}

impl Default for TurnAssist {
    fn default() -> Self {
        Self { begin_radians: 0.5, full_radians: 1.4 }
    }
}

impl TurnAssist {
    /// The goal of a command with the coordinate adjusted. Goals that are no path's stay as they are.
    #[must_use]
    pub fn adjusted(self, graph: &PolicyGraph, state: &CharacterState, command: &Command) -> Goal {
        let (Goal::Path { path, coordinate }, Some(target)) = (command.goal, command.target) else {
            return command.goal;
        };
        let Some(nodes) = graph.paths().get(path.index()).map(|p| p.nodes()) else { return command.goal };
        let speed = |i: usize| graph.node(nodes[i]).speed_mps.unwrap_or(0.0);
        let Some(turning) = (0..nodes.len()).find(|&i| speed(i) > 0.0) else { return command.goal };
        let beyond =
            (libm::ceilf(coordinate.clamp(0.0, (nodes.len() - 1) as f32)) as usize).min(nodes.len() - 1);
        if beyond > turning && speed(beyond) < speed(turning) {
            return command.goal;
        }
        let weight = self.weight(state, target);
        Goal::Path { path, coordinate: coordinate + weight * (turning as f32 - coordinate) }
    }

    /// How far it acts, in [0, 1].
    fn weight(self, state: &CharacterState, target: glam::Vec2) -> f32 {
        let root = state.root();
        let to_target = target - root.position.truncate();
        if to_target.length_squared() < 1e-6 {
            return 0.0;
        }
        let local = Heading::from_rotation(root.rotation).heading_from_world_2d(to_target);
        let angle = libm::fabsf(libm::atan2f(local.y, local.x));
        let weight = (angle - self.begin_radians) / (self.full_radians - self.begin_radians);
        if weight.is_finite() { weight.clamp(0.0, 1.0) } else { 0.0 }
    }
}
