//! Giving way: a character that something holds up stops for a moment instead of walking on against it.
//!
//! A gait that is stopped from outside walks its feet away under a body that stays, and falls. Standing keeps its balance, and
//! from a stand it may push on.

use crate::command::{Command, Goal};
use crate::fall::fall_height;
use crate::graph::PolicyGraph;
use crate::heading::Heading;
use crate::path::GraphPosition;
use crate::state::CharacterState;
use crate::state_check::countdown_secs;

/// Cosine of the largest angle off the heading at which a target is ahead. A character that turns slows down by itself.
const AHEAD: f32 = 0.8;

/// Time constant of the low-pass on the speed, seconds.
const SPEED_SECS: f32 = 0.1;

/// Time constants with which the pace rises to the speed and fades, seconds. The first steps of a start are no pace yet.
const PACE_SECS: [f32; 2] = [0.4, 1.5];

/// Slowest pace that can be held up, metres per second.
const LEAST_PACE: f32 = 0.6;

/// Stops a character for a moment when it loses much of its speed towards its target without being asked to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GiveWay {
    /// Share of its pace below which it is held up, in (0, 1).
    pub held_up_share: f32,
    /// How long it stands then, seconds; at most 3600.
    pub stop_secs: f32,
}

impl Default for GiveWay {
    fn default() -> Self {
        Self { held_up_share: 0.5, stop_secs: 0.7 }
    }
}

/// What giving way remembers from tick to tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct GiveWayState {
    /// Low-passed speed towards the target, metres per second.
    pub(crate) speed: f32,
    /// Speed that it had lately and is still asked for, metres per second.
    pub(crate) pace: f32,
    /// How long it stands yet, seconds.
    pub(crate) stop_secs: f32,
}

impl GiveWay {
    /// The command, or the same at the beginning of its path and without a target while the character gives way. Goals that are
    /// no path's, and paths that don't begin with standing, stay as they are. So does a command of a character at a `position` in a
    /// low gait: under a low roof there is no room to stand.
    #[must_use]
    pub(crate) fn adjusted(
        self,
        memory: &mut GiveWayState,
        (graph, position): (&PolicyGraph, GraphPosition),
        state: &CharacterState,
        command: &Command,
        dt: f32,
    ) -> Command {
        let asked = asked_mps(graph, command).zip(command.target);
        let Some((asked_mps, target)) = asked.filter(|_| !is_low(graph, position, command)) else {
            *memory = GiveWayState::default();
            return *command;
        };
        let root = state.root();
        let to_target = (target - root.position.truncate()).normalize_or_zero();
        let along = root.linear_velocity.truncate().dot(to_target);
        memory.speed += (along - memory.speed) * (dt / SPEED_SECS).min(1.0);
        let [rises, fades] = PACE_SECS;
        let faded = memory.pace * (1.0 - dt / fades);
        let risen = memory.pace + (memory.speed - memory.pace) * (dt / rises).min(1.0);
        memory.pace = faded.max(risen).min(asked_mps);
        memory.stop_secs = (memory.stop_secs - dt).max(0.0);
        let ahead = Heading::from_rotation(root.rotation).direction().dot(to_target) > AHEAD;
        if ahead && memory.pace > LEAST_PACE && memory.speed < self.held_up_share * memory.pace {
            *memory = GiveWayState { pace: 0.0, stop_secs: countdown_secs(self.stop_secs), ..*memory };
        }
        match command.goal {
            Goal::Path { path, .. } if memory.stop_secs > 0.0 => {
                Command { goal: Goal::Path { path, coordinate: 0.0 }, target: None, ..*command }
            }
            _ => *command,
        }
    }
}

/// True between or at gaits of which one falls lower than standing does, the first of the command's path.
fn is_low(graph: &PolicyGraph, position: GraphPosition, command: &Command) -> bool {
    let Goal::Path { path, .. } = command.goal else { return false };
    let Some(first) = graph.paths().get(path.index()).map(|p| p.nodes()[0]) else { return false };
    fall_height(graph, position).unwrap_or(0.0) < graph.node(first).fall_height.unwrap_or(0.0)
}

/// Speed that a command asks for on a path that begins with standing, metres per second.
fn asked_mps(graph: &PolicyGraph, command: &Command) -> Option<f32> {
    let Goal::Path { path, coordinate } = command.goal else { return None };
    let nodes = graph.paths().get(path.index())?.nodes();
    let speed = |i: usize| graph.node(nodes[i]).speed_mps;
    if speed(0) != Some(0.0) {
        return None;
    }
    let coordinate = coordinate.clamp(0.0, (nodes.len() - 1) as f32);
    let below = libm::floorf(coordinate) as usize;
    let above = (below + 1).min(nodes.len() - 1);
    let (slow, fast) = (speed(below)?, speed(above)?);
    Some(slow + (coordinate - below as f32) * (fast - slow))
}
