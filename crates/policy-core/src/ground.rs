//! What a character senses of the ground: its height below the root, and how much higher or lower it is where the legs come to.
//!
//! A policy sees each leg's height above the ground that it is about to be above. On level ground that is the height above the
//! ground below the root, so policies that were trained there act on the same numbers as before.

use glam::Vec2;

use crate::ids::BodyId;
use crate::skeleton::Skeleton;
use crate::state::CharacterState;

/// A foot senses the ground at the place it reaches after these seconds at its present velocity.
pub const FOOT_LOOKAHEAD_SECS: f32 = 0.1;

/// The same for the body above a foot, whose joint leads a step.
pub const SHIN_LOOKAHEAD_SECS: f32 = 0.3;

/// Most that a policy sees of a rise or drop, metres. What is higher is no step.
pub const MAX_RISE_METRES: f32 = 0.25;

/// Most that a thing that can move may rise above the lower foot to be stepped onto, metres: a board does, a crate does not.
pub const MAX_STEP_METRES: f32 = 0.15;

/// Seconds after which the ground below a body counts: where it then is at its present velocity. `None` for a body that senses
/// no ground of its own.
#[must_use]
pub fn ground_lookahead_secs(skeleton: &Skeleton, body: BodyId) -> Option<f32> {
    legs(skeleton).find(|leg| leg.0 == body).map(|leg| leg.1)
}

/// Feet and the bodies above them, with the seconds that they look ahead.
fn legs(skeleton: &Skeleton) -> impl Iterator<Item = (BodyId, f32)> {
    let feet = skeleton.feet().iter();
    feet.flat_map(move |&foot| {
        let shin = skeleton.parent(foot).map(|shin| (shin, SHIN_LOOKAHEAD_SECS));
        core::iter::once((foot, FOOT_LOOKAHEAD_SECS)).chain(shin)
    })
}

impl CharacterState {
    /// Senses the ground below the root and where the legs come to. `height` returns the height of the ground at a point of the
    /// world, metres; it is asked once for the root and twice for each foot. Does not allocate.
    ///
    /// The bodies have to be sensed before. Heights that are not finite leave a rise of zero.
    ///
    /// # Panics
    /// When the state does not fit the skeleton.
    pub fn sense_ground(&mut self, skeleton: &Skeleton, mut height: impl FnMut(Vec2) -> f32) {
        assert!(self.fits(skeleton), "a state of the skeleton");
        let below_root = height(self.root().position.truncate());
        self.set_ground(skeleton, below_root, |_, at| height(at));
    }

    /// Sets the height of the ground below the root, and those where the legs come to: `height` gets a body and the point that
    /// it comes to. As [`CharacterState::sense_ground`] otherwise.
    ///
    /// # Panics
    /// When the state does not fit the skeleton.
    pub fn set_ground(
        &mut self,
        skeleton: &Skeleton,
        below_root: f32,
        mut height: impl FnMut(BodyId, Vec2) -> f32,
    ) {
        assert!(self.fits(skeleton), "a state of the skeleton");
        self.ground_height = below_root;
        for (body, lookahead_secs) in legs(skeleton) {
            let moving = self.body(body);
            let comes_to = moving.position + lookahead_secs * moving.linear_velocity;
            let rise = height(body, comes_to.truncate()) - below_root;
            self.ground_rises[body.index()] =
                if rise.is_finite() { rise.clamp(-MAX_RISE_METRES, MAX_RISE_METRES) } else { 0.0 };
        }
    }

    /// Height up to which a thing that can move is ground to this character, metres, world space: [`MAX_STEP_METRES`] above the
    /// lower foot. What is higher is in its way; to a character without feet all of it is. A physics engine asks for it before it asks what is below.
    ///
    /// # Panics
    /// When the state does not fit the skeleton.
    #[must_use]
    pub fn step_top(&self, skeleton: &Skeleton) -> f32 {
        assert!(self.fits(skeleton), "a state of the skeleton");
        let feet = skeleton.feet().iter().map(|&foot| self.body(foot).position.z);
        feet.reduce(f32::min).map_or(f32::NEG_INFINITY, |lower| lower + MAX_STEP_METRES)
    }

    /// Senses level ground of this height, metres: nothing rises.
    pub fn sense_level_ground(&mut self, height: f32) {
        self.ground_height = height;
        self.ground_rises.fill(0.0);
    }
}

#[cfg(test)]
mod tests {
    use alloc::vec::Vec;

    use super::*;
    use crate::observation::observe_into;
    use crate::skeleton::Roles;
    use glam::Vec3;

    fn observed(state: &CharacterState) -> [f32; 223] {
        let mut observation = [0.0; 223];
        observe_into(&Skeleton::humanoid(), state, &mut observation);
        observation
    }

    #[test]
    fn a_leg_sees_the_step_it_comes_to_before_it_is_there() {
        let skeleton = Skeleton::humanoid();
        let foot = skeleton.feet()[0];
        let shin = skeleton.parent(foot).unwrap();
        let step = |at: Vec2| if at.x > 0.4 { 0.1 } else { 0.0 };
        let mut state = CharacterState::new(&skeleton);
        state.bodies[0].position.z = 0.9;
        state.body_mut(foot).position = Vec3::new(0.25, 0.0, 0.1);
        state.sense_ground(&skeleton, step);
        assert_eq!(state.ground_rises, [0.0; 15], "a foot at rest before the step");
        state.body_mut(foot).linear_velocity.x = 2.0;
        state.sense_ground(&skeleton, step);
        assert_eq!((state.ground_rises[foot.index()], state.ground_rises[shin.index()]), (0.1, 0.0));
        state.body_mut(shin).linear_velocity.x = 1.5;
        state.sense_ground(&skeleton, step);
        assert_eq!(state.ground_rises[shin.index()], 0.1);
        let mut level = state.clone();
        level.sense_level_ground(0.0);
        let (seen, before) = (observed(&state), observed(&level));
        let changed: Vec<usize> = (0..223).filter(|&i| seen[i] != before[i]).collect();
        assert_eq!(changed, [3 * shin.index(), 3 * foot.index()], "the heights of two bodies alone");
        assert!((before[changed[1]] - seen[changed[1]] - 0.1).abs() < 1e-6);
    }

    #[test]
    fn level_ground_at_any_height_is_seen_as_at_zero() {
        let skeleton = Skeleton::humanoid();
        let mut state = CharacterState::new(&skeleton);
        state.bodies[0].position.z = 3.9;
        state.sense_ground(&skeleton, |_| 3.0);
        assert_eq!((state.ground_height, state.ground_rises.iter().all(|rise| *rise == 0.0)), (3.0, true));
    }

    #[test]
    fn what_moves_is_ground_up_to_a_step_above_the_lower_foot() {
        let skeleton = Skeleton::humanoid();
        let mut state = CharacterState::new(&skeleton);
        let [left, right] = [skeleton.feet()[0], skeleton.feet()[1]];
        state.body_mut(left).position.z = 0.4;
        state.body_mut(right).position.z = 0.05;
        assert!((state.step_top(&skeleton) - 0.05 - MAX_STEP_METRES).abs() < 1e-6);
        let roles = Roles { feet: Vec::new(), ..skeleton.roles().clone() };
        let footless =
            Skeleton::from_parts(skeleton.bodies().to_vec(), skeleton.joints().to_vec(), roles).unwrap();
        assert_eq!(state.step_top(&footless), f32::NEG_INFINITY, "nothing is");
    }

    #[test]
    fn a_wall_is_no_step_and_no_ground_is_none() {
        let skeleton = Skeleton::humanoid();
        let mut state = CharacterState::new(&skeleton);
        let foot = skeleton.feet()[1];
        state.body_mut(foot).position.x = 1.0;
        for (height, expected) in [(5.0, MAX_RISE_METRES), (-5.0, -MAX_RISE_METRES), (f32::NAN, 0.0)] {
            state.sense_ground(&skeleton, |at| if at.x > 0.5 { height } else { 0.0 });
            assert_eq!(state.ground_rises[foot.index()], expected);
        }
    }
}
