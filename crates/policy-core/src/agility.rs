//! Agility: while a character does not move yet as it is asked to, a gait is blended with its agile variant.
//!
//! A gait that turns, starts or stops quickly looks hurried while it walks straight ahead. So the variant acts in the moments in which
//! it is needed, and the gait acts alone, with the bits that it has without a variant, once the character goes as it is asked to.

use glam::Vec2;

use crate::graph::PolicyGraph;
use crate::heading::Heading;
use crate::path::GraphPosition;
use crate::state::CharacterState;

/// Velocity errors between which the variant comes in, relative to the speed of the gait.
const OFF_VELOCITY: [f32; 2] = [0.3, 0.6];

/// Angles between heading and target between which it comes in, radians.
const OFF_HEADING: [f32; 2] = [0.5, 1.0];

/// Velocity errors are relative to at least this, metres per second: standing has no speed.
const LEAST_SPEED: f32 = 0.5;

/// Within this distance of the target a character slows down, metres.
const BRAKING_METRES: f32 = 1.0;

/// Time from a gait to its variant, and back, seconds.
const CROSS_SECS: [f32; 2] = [0.1, 0.3];

/// How far the character is from what it is asked to do, in [0, 1], after a tick of `dt` seconds.
///
/// Without a target it is asked to stand, whatever the speed at its position on the graph. Gaits without a speed ask for nothing.
pub(crate) fn next_urgency(
    before: f32,
    (graph, position): (&PolicyGraph, GraphPosition),
    state: &CharacterState,
    target: Option<Vec2>,
    dt: f32,
) -> f32 {
    let now = asked_mps(graph, position).map_or(0.0, |speed| urgency(state, target, speed));
    let [to_variant, to_gait] = CROSS_SECS;
    now.clamp(before - dt / to_gait, before + dt / to_variant).clamp(0.0, 1.0)
}

/// Speed of a position on the graph, metres per second, where its gaits have one.
fn asked_mps(graph: &PolicyGraph, position: GraphPosition) -> Option<f32> {
    let speed = |node| graph.node(node).speed_mps;
    let (from, to) = (speed(position.from)?, speed(position.to)?);
    Some(from + position.t * (to - from))
}

fn urgency(state: &CharacterState, target: Option<Vec2>, speed: f32) -> f32 {
    let root = state.root();
    let to_target = target.map_or(Vec2::ZERO, |target| target - root.position.truncate());
    let distance = libm::sqrtf(to_target.length_squared());
    let near = (distance / BRAKING_METRES).min(1.0);
    let direction = if distance > 1e-3 { to_target / distance } else { Vec2::ZERO };
    let error = root.linear_velocity.truncate() - near * speed * direction;
    let off_velocity = libm::sqrtf(error.length_squared()) / speed.max(LEAST_SPEED);
    let local = Heading::from_rotation(root.rotation).heading_from_world_2d(direction);
    // A character that stands need not face its target.
    let off_heading = if speed > 0.0 { near * libm::fabsf(libm::atan2f(local.y, local.x)) } else { 0.0 };
    let within =
        |value: f32, [begins, fully]: [f32; 2]| ((value - begins) / (fully - begins)).clamp(0.0, 1.0);
    let most = within(off_velocity, OFF_VELOCITY).max(within(off_heading, OFF_HEADING));
    if most.is_finite() { most } else { 0.0 }
}
