//! A stick as a game has it: its target goes ahead of the character, turn assist and steering correct it, and its release
//! leads back to standing.

use glam::Vec2;
use policy_core::training::{SteeringState, TARGET_RANGE_METRES};
use policy_core::{CharacterState, Goal, Steering, TurnAssist};

use super::super::graph::TrainingGraph;
use super::{Command, DT_SECS};

impl Command {
    /// A stick's target goes ahead of the character; below the second node of a path that begins with standing it is as
    /// near as the stick is pushed little.
    pub(super) fn follow_stick(&mut self, graph: &TrainingGraph, position: Vec2) {
        if let Some(direction) = self.stick_radians() {
            self.target = position + self.push(graph) * TARGET_RANGE_METRES * Vec2::from_angle(direction);
        }
    }

    /// Points a stick this way, radians, in place of its first direction.
    pub(in super::super) fn go_straight(&mut self, graph: &TrainingGraph, position: Vec2, radians: f32) {
        if let Some(direction) = &mut self.stick {
            *direction = radians;
        }
        self.follow_stick(graph, position);
        self.seen_target = self.target;
    }

    /// How far the stick is pushed, in [0, 1].
    fn push(&self, graph: &TrainingGraph) -> f32 {
        match (self.stop, graph.begins_standing(self.path)) {
            (true, _) => 0.0,
            (false, true) => self.asked.min(1.0),
            (false, false) => 1.0,
        }
    }

    /// Speed that a stick asks for at once while the coordinate leaves standing, metres per second: that of the path's first
    /// gait, as far as the stick is pushed.
    #[must_use]
    pub fn prompt_mps(&self, graph: &TrainingGraph) -> f32 {
        let from_standing = self.stick.is_some() && self.coordinate < 1.0 && graph.begins_standing(self.path);
        let asked = if from_standing { self.push(graph) } else { 0.0 };
        graph.speed_mps(graph.position(self.path, asked)) * f32::from(u8::from(asked > 0.0))
    }

    /// Sets where the policy sees the target and returns the coordinate to go to, as a game's controller does with a stick.
    pub(super) fn assist(&mut self, graph: &TrainingGraph, state: &CharacterState) -> f32 {
        let coordinate = if self.is_released() { 0.0 } else { self.asked };
        self.seen_target = self.target;
        if !self.assisted || graph.strafe(self.position).0 > 0.0 {
            return coordinate;
        }
        if self.push(graph) == 0.0 {
            self.steering = SteeringState::default();
            return coordinate;
        }
        let asked = policy_core::Command {
            goal: Goal::Path { path: self.path, coordinate },
            target: Some(self.target),
            ..policy_core::Command::default()
        };
        let assisted = TurnAssist::default().adjusted(graph.policy_graph(), state, &asked);
        let target = assisted.target.unwrap_or(self.target);
        self.seen_target = Steering::default().adjusted(&mut self.steering, state, target, 1.0, DT_SECS);
        match assisted.goal {
            Goal::Path { coordinate, .. } => coordinate,
            _ => coordinate,
        }
    }

    /// True while the stick is released on a path that it moves along: the coordinate goes back to standing. Gaits slower than
    /// a walk stop by the target alone, because a trigger or a button holds them.
    pub(super) fn is_released(&self) -> bool {
        self.assisted && self.stop && self.leads_to_standing
    }
}

#[cfg(test)]
#[path = "stick_tests.rs"]
mod tests;
