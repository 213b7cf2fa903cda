//! Balance: whether a body is about to come to rest above its feet, or to tip over.
//!
//! A body that swings about its feet like a pendulum stood on its end comes to rest above the point `p + v / w`, where `p` and `v` are place
//! and velocity of its centre of mass, and `w = sqrt(g / h)` for its height `h` (A. L. Hof and others, *The condition for dynamic
//! stability*, Journal of Biomechanics 38, 2005). Beside the feet it tips over, however slowly it moves as yet.

use glam::{Vec2, Vec3};

use crate::heading::Heading;
use crate::skeleton::Skeleton;
use crate::state::CharacterState;

/// Metres per second squared.
const GRAVITY: f32 = 9.81;

/// A body this low lies, metres.
const LEAST_HEIGHT: f32 = 0.2;

/// How far from the middle of its ankles a body may come to rest, aside, behind and ahead, as shares of its height above them. A foot is
/// longer ahead of the ankle, and a body that is driven on takes a step.
const ASIDE: f32 = 0.075;
const BEHIND: f32 = 0.04;
const AHEAD: f32 = 0.34;

/// Whether a body is about to come to rest above its feet. A skeleton that names no head or no feet always is.
pub(crate) fn is_balanced(skeleton: &Skeleton, state: &CharacterState) -> bool {
    comes_to_rest(skeleton, state).is_none_or(|at| at.y.abs() < ASIDE && at.x > -BEHIND && at.x < AHEAD)
}

/// Velocity of the trunk, metres per second: the mean of root and head. A push on the trunk moves the head first, one on the hips the root. A
/// skeleton without a head has the root's alone.
pub(crate) fn trunk_velocity(skeleton: &Skeleton, state: &CharacterState) -> Vec3 {
    let root = state.root().linear_velocity;
    let head = skeleton.head().map_or(root, |head| state.body(head).linear_velocity);
    0.5 * (root + head)
}

/// Where a body comes to rest from the middle of its ankles, along its heading and to the left, as shares of its height above them.
///
/// What it weighs is not known here: the centre of mass is taken to be half-way from the root to the head.
pub(crate) fn comes_to_rest(skeleton: &Skeleton, state: &CharacterState) -> Option<Vec2> {
    let (root, head) = (state.root(), state.body(skeleton.head()?));
    let feet = Some(skeleton.feet()).filter(|feet| !feet.is_empty())?;
    let ankles = feet.iter().map(|foot| state.body(*foot).position).sum::<Vec3>() / feet.len() as f32;
    let centre = 0.5 * (root.position + head.position) - ankles;
    let velocity = trunk_velocity(skeleton, state);
    let height = centre.z.max(LEAST_HEIGHT);
    let at = centre.truncate() + velocity.truncate() * libm::sqrtf(height / GRAVITY);
    Some(Heading::from_rotation(root.rotation).heading_from_world_2d(at / height))
}

#[cfg(test)]
mod tests {
    use glam::Quat;

    use super::*;
    use crate::skeleton::Roles;

    /// A body whose ankles are below the root, that moves as a whole.
    fn upright(velocity: Vec2) -> CharacterState {
        let skeleton = Skeleton::humanoid();
        let mut state = CharacterState::new(&skeleton);
        for body in &mut state.bodies {
            body.position.z = 0.9;
            body.linear_velocity = velocity.extend(0.0);
        }
        state.body_mut(skeleton.head().unwrap()).position.z = 1.36;
        for foot in skeleton.feet() {
            state.body_mut(*foot).position.z = 0.07;
        }
        state
    }

    #[test]
    fn a_body_tips_over_where_it_comes_to_rest_beside_its_feet() {
        let skeleton = Skeleton::humanoid();
        // From 1.06 m above its feet it comes to rest 0.33 s ahead.
        let at = comes_to_rest(&skeleton, &upright(Vec2::new(0.3, 0.0))).unwrap();
        assert!((at.x * 1.06 - 0.3 * 0.329).abs() < 1e-3 && at.y == 0.0, "{at}");
        let balanced = |x, y| is_balanced(&skeleton, &upright(Vec2::new(x, y)));
        assert!(balanced(0.0, 0.0) && balanced(0.9, 0.0) && balanced(0.0, 0.2) && balanced(-0.1, -0.2));
        assert!(!balanced(1.2, 0.0) && !balanced(0.0, 0.3) && !balanced(0.0, -0.3) && !balanced(-0.2, 0.0));
    }

    #[test]
    fn a_body_that_leans_and_rests_tips_over_too_whichever_way_it_faces() {
        let skeleton = Skeleton::humanoid();
        for angle in [0.0, 1.0, -2.5] {
            let leans = |ahead: f32, left: f32| {
                let mut state = upright(Vec2::ZERO);
                let heading = Heading::from_angle(angle);
                state.bodies[0].rotation = Quat::from_rotation_z(angle);
                for foot in skeleton.feet() {
                    let off = heading.world_from_heading_2d(Vec2::new(-ahead, -left));
                    state.body_mut(*foot).position += off.extend(0.0);
                }
                !is_balanced(&skeleton, &state)
            };
            assert!(!leans(0.2, 0.0) && !leans(0.0, 0.05) && !leans(0.0, -0.05));
            assert!(leans(0.4, 0.0) && leans(-0.1, 0.0) && leans(0.0, 0.1) && leans(0.0, -0.1));
        }
    }

    #[test]
    fn without_feet_or_a_head_nothing_is_known() {
        let humanoid = Skeleton::humanoid();
        let (bodies, joints) = (humanoid.bodies().to_vec(), humanoid.joints().to_vec());
        let nameless = Skeleton::from_parts(bodies, joints, Roles::default()).unwrap();
        let mut leans = upright(Vec2::new(0.0, 2.0));
        assert!(!is_balanced(&humanoid, &leans) && is_balanced(&nameless, &leans));
        leans.bodies[0].position.z = 0.0;
        assert!(comes_to_rest(&humanoid, &leans).is_some_and(Vec2::is_finite));
    }
}
