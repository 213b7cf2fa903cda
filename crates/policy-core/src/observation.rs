//! What a policy sees: the body and the target, all in the heading frame of the root.
//!
//! Order for B bodies: height of the root above the ground (1); positions of the other bodies relative to the root, those of
//! the legs lowered by the rise of the ground that they come to (3 B - 3); x and z axes of all bodies (6 B); linear velocities (3 B); angular velocities (3 B). The target
//! follows as the last two policy inputs, after normalisation.

use glam::{Vec2, Vec3};

use crate::heading::{Heading, axes_xz};
use crate::skeleton::Skeleton;
use crate::state::CharacterState;

/// Numbers of the target.
pub const TARGET_LEN: usize = 2;

/// A target farther away than this, in metres, asks for no more speed.
pub const TARGET_RANGE_METRES: f32 = 5.0;

/// Writes the raw observation of `state` to `out`: metres, metres per second, radians per second.
///
/// Every number is finite when the state is ([`CharacterState::is_finite`]). Does not allocate.
///
/// # Panics
/// When the state does not fit the skeleton, or `out` is not [`Skeleton::observation_len`] long.
///
/// ```
/// use policy_core::{CharacterState, Skeleton, observe_into};
/// let skeleton = Skeleton::humanoid();
/// let mut state = CharacterState::new(&skeleton);
/// state.bodies[0].position.z = 0.9;
/// let mut observation = vec![0.0; skeleton.observation_len()];
/// observe_into(&skeleton, &state, &mut observation);
/// assert_eq!(observation[0], 0.9);
/// ```
pub fn observe_into(skeleton: &Skeleton, state: &CharacterState, out: &mut [f32]) {
    assert!(state.fits(skeleton), "a state of the skeleton");
    assert_eq!(out.len(), skeleton.observation_len(), "numbers of an observation");
    let root = state.root();
    let heading = Heading::from_rotation(root.rotation);
    let mut cursor = Cursor { out, at: 0 };
    cursor.push(state.root_height());
    // A skeleton has a body, the state fits it, and `observation_len` counts what is pushed.
    for (body, rise) in state.bodies[1..].iter().zip(&state.ground_rises[1..]) {
        let place = heading.heading_from_world(body.position - root.position);
        cursor.push3(place.with_z(place.z - rise));
    }
    for body in &state.bodies {
        let (x, z) = axes_xz(body.rotation);
        cursor.push3(heading.heading_from_world(x));
        cursor.push3(heading.heading_from_world(z));
    }
    for body in &state.bodies {
        cursor.push3(heading.heading_from_world(body.linear_velocity));
    }
    for body in &state.bodies {
        cursor.push3(heading.heading_from_world(body.angular_velocity));
    }
}

/// Where the x axis of the root begins in an observation: after a height and the positions of the other bodies.
pub(crate) fn root_axis_at(skeleton: &Skeleton) -> usize {
    1 + 3 * (skeleton.body_count() - 1)
}

/// The target as a policy sees it: its direction in the heading frame times min(distance, 5 m) / 2.
///
/// `target_world` is a point on the ground in metres. A target below the root gives zero.
#[must_use]
pub fn target_input(state: &CharacterState, target_world: Vec2) -> [f32; TARGET_LEN] {
    let root = state.root();
    let to_target = target_world - root.position.truncate();
    let distance = libm::sqrtf(to_target.x * to_target.x + to_target.y * to_target.y);
    if !distance.is_finite() || distance < 1e-6 {
        return [0.0; TARGET_LEN];
    }
    let heading = Heading::from_rotation(root.rotation);
    let scale = distance.min(TARGET_RANGE_METRES) / (2.0 * distance);
    let local = heading.heading_from_world_2d(to_target) * scale;
    [local.x, local.y]
}

/// Writes vectors one behind the other.
pub(crate) struct Cursor<'a> {
    pub(crate) out: &'a mut [f32],
    pub(crate) at: usize,
}

impl Cursor<'_> {
    #[inline]
    pub(crate) fn push(&mut self, value: f32) {
        self.out[self.at] = value;
        self.at += 1;
    }

    #[inline]
    pub(crate) fn push3(&mut self, v: Vec3) {
        self.out[self.at..self.at + 3].copy_from_slice(&[v.x, v.y, v.z]);
        self.at += 3;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Quat;

    fn turned_and_moved(state: &CharacterState, turn: f32, shift: Vec3) -> CharacterState {
        let q = Quat::from_rotation_z(turn);
        let mut moved = state.clone();
        for b in &mut moved.bodies {
            b.position = q * b.position + shift;
            b.rotation = q * b.rotation;
            b.linear_velocity = q * b.linear_velocity;
            b.angular_velocity = q * b.angular_velocity;
        }
        moved.ground_height += shift.z;
        moved
    }

    fn some_state() -> CharacterState {
        let mut state = CharacterState::new(&Skeleton::humanoid());
        for (i, b) in state.bodies.iter_mut().enumerate() {
            let f = i as f32;
            b.position = Vec3::new(0.1 * f, 0.05 * f - 0.2, 1.0 - 0.03 * f);
            b.rotation = Quat::from_xyzw(0.1 * f, 0.2, -0.05 * f, 1.0).normalize();
            b.linear_velocity = Vec3::new(1.0 - 0.1 * f, 0.2, 0.01 * f);
            b.angular_velocity = Vec3::new(0.3, -0.1 * f, 0.2);
        }
        state
    }

    #[test]
    fn observation_does_not_depend_on_place_or_heading() {
        let state = some_state();
        let moved = turned_and_moved(&state, 2.1, Vec3::new(3.0, -7.0, 0.4));
        let skeleton = Skeleton::humanoid();
        let (mut a, mut b) = ([0.0; 223], [0.0; 223]);
        observe_into(&skeleton, &state, &mut a);
        observe_into(&skeleton, &moved, &mut b);
        let worst = a.iter().zip(&b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(worst < 2e-6, "{worst}");
    }

    #[test]
    fn target_is_bounded_and_in_the_heading_frame() {
        let mut state = CharacterState::new(&Skeleton::humanoid());
        assert_eq!(target_input(&state, Vec2::new(2.0, 0.0)), [1.0, 0.0]);
        assert_eq!(target_input(&state, Vec2::new(50.0, 0.0)), [2.5, 0.0]);
        assert_eq!(target_input(&state, Vec2::ZERO), [0.0, 0.0]);
        assert_eq!(target_input(&state, Vec2::new(f32::NAN, 0.0)), [0.0, 0.0]);
        state.bodies[0].rotation = Quat::from_rotation_z(core::f32::consts::FRAC_PI_2);
        let [x, y] = target_input(&state, Vec2::new(0.0, 3.0));
        assert!((x - 1.5).abs() < 1e-6 && y.abs() < 1e-6);
    }
}
