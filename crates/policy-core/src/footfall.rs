//! Footfall: the moment of a stride in which a foot comes down. A skill that continues a run begins in step with it.

use crate::ids::BodyId;
use crate::skeleton::Skeleton;
use crate::state::CharacterState;

/// A foot that is slower than this share of the root stands.
const STANDS_SHARE: f32 = 0.5;

/// True while a foot stands ahead of the root, along the root's velocity: in a run, for about 0.1 s from touch-down on.
///
/// Always true of a skeleton that names no feet, and never of a root that rests.
#[must_use]
pub fn foot_comes_down(skeleton: &Skeleton, state: &CharacterState) -> bool {
    let root = state.root();
    let velocity = root.linear_velocity.truncate();
    let comes_down = |foot: BodyId| {
        let foot = state.body(foot);
        let stands = foot.linear_velocity.truncate().length() < STANDS_SHARE * velocity.length();
        stands && (foot.position - root.position).truncate().dot(velocity) > 0.0
    };
    skeleton.feet().is_empty() || skeleton.feet().iter().copied().any(comes_down)
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::skeleton::Roles;

    #[test]
    fn a_foot_comes_down_once_it_stands_ahead_of_the_root() {
        let skeleton = Skeleton::humanoid();
        let mut state = CharacterState::new(&skeleton);
        let [left, right] = [skeleton.feet()[0], skeleton.feet()[1]];
        state.bodies[0].linear_velocity = Vec3::new(0.0, 2.0, 0.3);
        let mut at = |ahead: f32, speed: f32| {
            state.body_mut(left).position.y = ahead;
            state.body_mut(left).linear_velocity.y = speed;
            state.body_mut(right).linear_velocity.y = 2.5;
            foot_comes_down(&skeleton, &state)
        };
        assert!(at(0.2, 0.1) && at(0.05, 0.9), "it stands ahead");
        assert!(!at(0.2, 1.1), "it swings ahead");
        assert!(!at(-0.05, 0.1), "it stands behind");
    }

    #[test]
    fn a_body_that_rests_steps_on_nothing_and_one_without_feet_always() {
        let skeleton = Skeleton::humanoid();
        assert!(!foot_comes_down(&skeleton, &CharacterState::new(&skeleton)));
        let (bodies, joints) = (skeleton.bodies().to_vec(), skeleton.joints().to_vec());
        let without_feet = Skeleton::from_parts(bodies, joints, Roles::default()).unwrap();
        assert!(foot_comes_down(&without_feet, &CharacterState::new(&without_feet)));
    }
}
