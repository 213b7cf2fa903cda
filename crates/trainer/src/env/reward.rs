//! Task rewards, pure functions of what happened in a tick. All lie in [0, 1].

use glam::{Vec2, Vec3};
use physics_bridge::Contact;
use policy_core::{Body, CharacterState, Heading};

/// What a tick was worth, before the weights of a phase.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RewardTerms {
    /// Task reward, 0 to 1.
    pub task: f32,
    /// For being like the clip at the moment that is to be imitated, 0 to 1.
    pub imitation: f32,
    /// Speed towards the target, metres per second.
    pub speed_mps: f32,
    /// Speed commanded, metres per second.
    pub commanded_mps: f32,
    /// How fast the feet slide, see [`slide_mps`].
    pub slide_mps: f32,
}

impl RewardTerms {
    /// With a share of the task reward for a pelvis at a height above the ground, metres: `exp(-|error| / 0.15)`.
    #[must_use]
    pub fn with_height(self, state: &CharacterState, (share, metres): (f32, f32)) -> Self {
        let height = state.height_of(Body::Pelvis);
        let reward = (-(height - metres).abs() / 0.15).exp();
        Self { task: (1.0 - share) * self.task + share * reward, ..self }
    }
}

/// How fast the feet slide over what they stand on, metres per second, weighed by the share of the character's weight that
/// presses there; at most 1. Sliding is easy for a policy and cheap by every other reward, but no creature walks like that.
#[must_use]
pub fn slide_mps(state: &CharacterState, contacts: &[Contact], weight_newton: f32) -> f32 {
    let feet = contacts.iter().filter(|c| matches!(c.body, Body::LeftFoot | Body::RightFoot));
    let sum: f32 = feet
        .map(|contact| {
            let foot = state.body(contact.body);
            let arm = contact.position - foot.position;
            let velocity = foot.linear_velocity + foot.angular_velocity.cross(arm);
            let along = velocity - contact.normal * velocity.dot(contact.normal);
            along.length() * contact.force.dot(contact.normal).max(0.0)
        })
        .sum();
    (sum / weight_newton).min(1.0)
}

/// Within this distance of the target the commanded speed falls to zero, metres.
const BRAKING_METRES: f32 = 1.0;

/// How a target is to be gone to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Manner {
    /// Speed, metres per second.
    pub speed_mps: f32,
    /// Least error of the speed that counts as a large one, metres per second.
    pub least_width_mps: f32,
    /// Share of the reward for facing the target that only who nearly faces it gets, 0 to 1.
    pub strict_facing: f32,
}

/// Angle to the target at which the strict reward for facing it has fallen to 1/e, radians.
const STRICT_FACING_RADIANS: f32 = 0.4;

/// Reward for going to `target` in a manner and facing it. `velocity` is that of the pelvis over the tick.
///
/// `0.4 exp(-2 d) + 0.3 exp(-2 d / 9) + 0.3 facing` with `d = (e^2 + 0.25 s^2) / w^2`, speed error `e`, sideways speed `s`
/// and a width `w`, metres per second, that grows with the commanded speed from the least width on, evenly below a walk and with
/// the root above. The narrow bell makes the speed exact; the wide one gives a walk
/// that is asked to run, or to stand, a slope to go down. Facing falls evenly from 1 to 0 straight behind, so that who goes
/// the wrong way altogether gains by every degree too; the strict share of it is a bell, or who goes a little sideways
/// hardly pays for it.
#[must_use]
pub fn target_reward(state: &CharacterState, velocity: Vec2, target: Vec2, manner: Manner) -> RewardTerms {
    let pelvis = state.body(Body::Pelvis);
    let to_target = target - pelvis.position.truncate();
    let distance = to_target.length();
    let facing_now = Heading::from_rotation(pelvis.rotation).direction();
    let near = (distance / BRAKING_METRES).min(1.0);
    let direction = if distance > 1e-3 { to_target / distance } else { facing_now };
    let commanded_mps = manner.speed_mps * near;
    let along = velocity.dot(direction);
    let sideways = velocity.perp_dot(direction);
    let pace = commanded_mps / 1.25;
    let width = (0.6 * pace.min(pace.sqrt())).max(manner.least_width_mps);
    let error = ((along - commanded_mps).powi(2) + 0.25 * sideways * sideways) / (width * width);
    // Close by, which way the target lies says nothing.
    let aside = facing_now.angle_to(direction);
    let evenly = aside.abs() / std::f32::consts::PI;
    let steeply = 1.0 - (-(aside / STRICT_FACING_RADIANS).powi(2)).exp();
    let facing = 1.0 - near * (evenly + manner.strict_facing * (steeply - evenly));
    let speed = 0.4 * (-2.0 * error).exp() + 0.3 * (-2.0 * error / 9.0).exp();
    RewardTerms { task: speed + 0.3 * facing, speed_mps: along, commanded_mps, ..RewardTerms::default() }
}

/// Speed of the pelvis up to which a rise is at ease, metres per second.
const RISING_MPS: f32 = 1.2;

/// Reward for standing: pelvis and head at their heights, trunk upright, still once it is up, without a leap.
#[must_use]
pub fn standing_reward(state: &CharacterState) -> RewardTerms {
    let pelvis = (state.height_of(Body::Pelvis) / 0.83).clamp(0.0, 1.0);
    let head = (state.height_of(Body::Head) / 1.25).clamp(0.0, 1.0);
    let up = (state.body(Body::Torso).rotation * Vec3::Z).z.max(0.0);
    let speed = state.body(Body::Pelvis).linear_velocity.truncate().length();
    let height = 0.5 * (pelvis + head);
    let still = if height > 0.9 { (-speed * speed).exp() } else { 0.0 };
    // Nobody jumps to his feet: what is faster than a rise at ease pays little.
    let excess = (state.body(Body::Pelvis).linear_velocity.length() - RISING_MPS).max(0.0);
    let calm = (-3.0 * excess).exp();
    // Linear in the height, so that the first centimetres off the ground pay as well as the last.
    let task = calm * (0.5 * height + 0.3 * height * up + 0.2 * still);
    RewardTerms { task, ..RewardTerms::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn manner(speed_mps: f32, least_width_mps: f32) -> Manner {
        Manner { speed_mps, least_width_mps, strict_facing: 0.0 }
    }

    #[test]
    fn the_right_speed_towards_the_target_is_worth_one() {
        let state = CharacterState::default();
        let terms = target_reward(&state, Vec2::new(1.25, 0.0), Vec2::new(5.0, 0.0), manner(1.25, 0.6));
        assert!((terms.task - 1.0).abs() < 1e-6);
        let away = target_reward(&state, Vec2::new(-1.25, 0.0), Vec2::new(5.0, 0.0), manner(1.25, 0.6));
        assert!(away.task < 0.5);
    }

    #[test]
    fn a_walk_asked_to_run_or_to_stand_feels_a_slope() {
        let state = CharacterState::default();
        let at = |speed: f32| {
            target_reward(&state, Vec2::new(speed, 0.0), Vec2::new(5.0, 0.0), manner(3.5, 0.6)).task
        };
        assert!(at(1.5) - at(1.3) > 0.02, "{} {}", at(1.5), at(1.3));
        let at = |speed: f32| {
            target_reward(&state, Vec2::new(speed, 0.0), Vec2::new(5.0, 0.0), manner(0.0, 0.6)).task
        };
        assert!(at(1.2) - at(1.4) > 0.02, "{} {}", at(1.2), at(1.4));
    }

    #[test]
    fn a_slow_gait_that_rests_misses_most_of_its_reward() {
        let state = CharacterState::default();
        let at =
            |speed: f32| target_reward(&state, Vec2::new(speed, 0.0), Vec2::new(5.0, 0.0), manner(0.34, 0.2));
        assert!(at(0.34).task - at(0.0).task > 0.4, "{}", at(0.0).task);
    }

    #[test]
    fn every_degree_towards_the_target_pays() {
        let state = CharacterState::default();
        let at = |degrees: f32| {
            let target = 5.0 * Vec2::from_angle(degrees.to_radians());
            target_reward(&state, Vec2::ZERO, target, manner(0.3, 0.6)).task
        };
        for degrees in (0..180).step_by(10).map(|d| d as f32) {
            assert!(at(degrees) - at(degrees + 10.0) > 0.01, "{degrees}");
            assert!((at(degrees) - at(-degrees)).abs() < 1e-6);
        }
    }

    #[test]
    fn a_strict_facing_makes_a_little_sideways_cost_much() {
        let state = CharacterState::default();
        let at = |degrees: f32, strict_facing: f32| {
            let target = 5.0 * Vec2::from_angle(degrees.to_radians());
            let manner = Manner { strict_facing, ..manner(0.3, 0.6) };
            target_reward(&state, 0.3 * target.normalize(), target, manner).task
        };
        assert!((at(0.0, 1.0) - 1.0).abs() < 1e-6 && (at(180.0, 0.5) - 0.7).abs() < 1e-4);
        // 0.3 of 30 degrees in 180, and of a bell of 0.4 radians.
        assert!((at(30.0, 0.0) - 0.95).abs() < 1e-4);
        assert!((at(30.0, 1.0) - (0.7 + 0.3 * (-(30.0_f32.to_radians() / 0.4).powi(2)).exp())).abs() < 1e-4);
        assert!((at(30.0, 0.5) - 0.5 * (at(30.0, 0.0) + at(30.0, 1.0))).abs() < 1e-6);
    }

    #[test]
    fn every_centimetre_off_the_ground_pays() {
        let at = |metres: f32| {
            let mut state = CharacterState::default();
            state.bodies[Body::Pelvis.index()].position.z = metres;
            state.bodies[Body::Head.index()].position.z = 1.5 * metres;
            standing_reward(&state).task
        };
        assert!(at(0.2) - at(0.1) > 0.05, "{} {}", at(0.2), at(0.1));
        assert!((at(0.9) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_foot_that_slides_under_the_weight_costs_and_one_that_rolls_or_swings_does_not() {
        let mut state = CharacterState::default();
        let foot = &mut state.bodies[Body::LeftFoot.index()];
        (foot.position, foot.linear_velocity) = (Vec3::new(0.0, 0.0, 0.05), Vec3::new(0.4, 0.3, 0.2));
        let touch = |body, newton: f32| Contact {
            body,
            other: None,
            position: Vec3::ZERO,
            normal: Vec3::Z,
            force: Vec3::new(50.0, 0.0, newton),
            depth: 0.0,
        };
        let both = [touch(Body::LeftFoot, 240.0), touch(Body::LeftHand, 240.0)];
        assert!((slide_mps(&state, &both, 480.0) - 0.25).abs() < 1e-6);
        assert_eq!(slide_mps(&state, &[], 480.0), 0.0);
        // The point that touches rests while the foot turns about it.
        let foot = &mut state.bodies[Body::LeftFoot.index()];
        (foot.linear_velocity, foot.angular_velocity) = (Vec3::new(0.4, 0.0, 0.0), Vec3::new(0.0, 8.0, 0.0));
        assert!(slide_mps(&state, &both, 480.0) < 1e-6);
    }

    #[test]
    fn at_the_target_standing_is_best_whatever_the_heading() {
        let state = CharacterState::default();
        let still = target_reward(&state, Vec2::ZERO, Vec2::ZERO, manner(1.25, 0.6));
        assert!((still.task - 1.0).abs() < 1e-6);
        assert!(target_reward(&state, Vec2::X, Vec2::ZERO, manner(1.25, 0.6)).task < 0.7);
    }
}
