//! Footfall: the moment of a stride in which a foot comes down. A skill that continues a run begins in step with it.

use crate::heading::Heading;
use crate::ids::BodyId;
use crate::skeleton::Skeleton;
use crate::state::CharacterState;

/// A foot that is slower than this share of the root stands.
const STANDS_SHARE: f32 = 0.5;

/// Largest angle between velocity and heading of a character that goes straight ahead, radians.
const STRAIGHT_RADIANS: f32 = core::f32::consts::FRAC_PI_6;

/// Fastest turn of such a character about the vertical, radians per second.
const STRAIGHT_RPS: f32 = 1.5;

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

/// True for a character that goes where it faces and hardly turns. Pressed in a turn or while it strafed, jumps in a stride fell.
#[must_use]
pub(crate) fn goes_straight(state: &CharacterState) -> bool {
    let root = state.root();
    let aside = Heading::from_rotation(root.rotation).angle_off(root.linear_velocity.truncate());
    aside <= STRAIGHT_RADIANS && root.angular_velocity.z.abs() <= STRAIGHT_RPS
}

#[cfg(test)]
mod tests {
    use glam::{Quat, Vec3};

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
    fn one_that_turns_or_moves_aside_does_not_go_straight() {
        let mut state = CharacterState::new(&Skeleton::humanoid());
        let mut goes = |velocity: Vec3, yaw_rps: f32, pitch: f32| {
            let root = &mut state.bodies[0];
            root.rotation = Quat::from_rotation_y(pitch);
            (root.linear_velocity, root.angular_velocity) = (velocity, yaw_rps * Vec3::Z);
            goes_straight(&state)
        };
        assert!(goes(Vec3::new(1.0, 0.5, 0.3), 1.4, 0.3), "27 degrees off, turning slowly, leaning");
        assert!(!goes(Vec3::new(1.0, 0.6, 0.0), 0.0, 0.0), "31 degrees off");
        assert!(!goes(Vec3::NEG_X, 0.0, 0.0) && !goes(Vec3::Y, 0.0, 0.0), "backwards, aside");
        assert!(!goes(Vec3::X, 1.6, 0.0) && !goes(Vec3::X, -1.6, 0.0), "it turns");
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
