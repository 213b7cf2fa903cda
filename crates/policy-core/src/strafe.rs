//! Strafing: facing one way and moving another, as games do when a character aims.
//!
//! In the heading frame the root's own x axis never points aside, so one number of the observation is always zero. For a strafing
//! policy that axis alone lies in the frame of the way to face: the number is the sine of what is left to turn. The policy needs no
//! further inputs, and everything else is as the other policies know it.

use glam::Vec2;

use crate::blend::Blend;
use crate::graph::PolicyGraph;
use crate::heading::Heading;
use crate::observation::root_axis_at;
use crate::path::GraphPosition;
use crate::skeleton::Skeleton;
use crate::state::CharacterState;

/// Largest angle that a policy sees left to turn, radians. Further turns are seen as this one.
const MOST_RADIANS: f32 = 0.5;

/// A character that strafes leaves for a gait that faces its target once it faces it within this, radians, ...
const LEAVES_RADIANS: f32 = 0.4;

/// ... and goes there at this speed, metres per second; without a target, once it is slower than this.
const LEAVES_MPS: f32 = 0.3;

/// The way to face, world, of a character that strafes at `position` on the graph and is to leave for `goal`, where no policy goes
/// backwards or aside: its target's, which it turns to and walks along first, or where it looks, until it stands. `None` when it
/// may leave.
pub(crate) fn waits_before_leaving(
    graph: &PolicyGraph,
    [position, goal]: [GraphPosition; 2],
    state: &CharacterState,
    target: Option<Vec2>,
) -> Option<Vec2> {
    let strafes = |position: GraphPosition| graph.node(position.nearest_node()).strafes;
    if !strafes(position) || strafes(goal) {
        return None;
    }
    let root = state.root();
    let (heading, velocity) = (Heading::from_rotation(root.rotation), root.linear_velocity.truncate());
    let way = target.map_or(Vec2::ZERO, |target| target - root.position.truncate());
    let Some(direction) = way.try_normalize() else {
        return (velocity.length() > LEAVES_MPS).then_some(heading.direction());
    };
    let ready = heading.angle_off(way) < LEAVES_RADIANS && velocity.dot(direction) > LEAVES_MPS;
    (!ready).then_some(direction)
}

/// Share of strafing policies in a blend, in [0, 1]: the mean of their blend weights over the layers.
#[must_use]
pub fn strafing_share(graph: &PolicyGraph, blend: &Blend) -> f32 {
    let strafes = |index: usize| graph.nodes().get(index).is_some_and(|node| node.strafes);
    let terms = blend.terms().iter().filter(|term| strafes(term.policy.index()));
    let share: f32 = terms.map(|term| term.weights.iter().sum::<f32>() / term.weights.len() as f32).sum();
    if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 }
}

/// Turns the root's x axis in an observation that is not normalised yet, so that it lies in the frame of `facing`: a world direction
/// of any length. By as much as `share` says, and by at most 0.5 radians. Without a direction, or with a share of 0, nothing changes.
///
/// # Panics
/// When `observation` is not [`Skeleton::observation_len`] long.
pub fn face_in_observation(
    skeleton: &Skeleton,
    state: &CharacterState,
    (facing, share): (Option<Vec2>, f32),
    observation: &mut [f32],
) {
    assert_eq!(observation.len(), skeleton.observation_len(), "numbers of an observation");
    let Some(facing) = facing.filter(|facing| share > 0.0 && facing.is_finite()) else { return };
    if facing.length_squared() < 1e-12 {
        return;
    }
    let local = Heading::from_rotation(state.root().rotation).heading_from_world_2d(facing);
    let left = libm::atan2f(local.y, local.x).clamp(-MOST_RADIANS, MOST_RADIANS) * share;
    let at = root_axis_at(skeleton);
    let axis = Vec2::new(observation[at], observation[at + 1]);
    let turned = Heading::from_angle(left).heading_from_world_2d(axis);
    observation[at..at + 2].copy_from_slice(&[turned.x, turned.y]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observation::observe_into;
    use glam::Quat;

    #[test]
    fn the_axis_of_the_root_alone_turns() {
        let skeleton = Skeleton::humanoid();
        let mut state = CharacterState::new(&skeleton);
        state.bodies[0].rotation = Quat::from_rotation_z(3.0);
        let mut plain = [0.0; 223];
        observe_into(&skeleton, &state, &mut plain);
        let axis = |facing: Option<f32>, share| {
            let facing = facing.map(|radians: f32| Vec2::from_angle(radians) * 2.0);
            let mut seen = plain;
            face_in_observation(&skeleton, &state, (facing, share), &mut seen);
            let others = seen.iter().zip(&plain).enumerate().all(|(i, (a, b))| a == b || i == 43 || i == 44);
            assert!(others);
            libm::atan2f(seen[44], seen[43])
        };
        let near =
            |is: f32, expected: f32| assert!((is - expected).abs() < 1e-5, "{is} instead of {expected}");
        near(axis(None, 1.0), 0.0);
        near(axis(Some(3.4), 0.0), 0.0);
        near(axis(Some(3.4), 1.0), -0.4);
        near(axis(Some(3.4), 0.5), -0.2);
        near(axis(Some(2.9), 1.0), 0.1);
        near(axis(Some(5.5), 1.0), -MOST_RADIANS);
        near(axis(Some(f32::NAN), 1.0), 0.0);
        let mut seen = plain;
        face_in_observation(&skeleton, &state, (Some(Vec2::ZERO), 1.0), &mut seen);
        assert_eq!(seen, plain);
    }
}
