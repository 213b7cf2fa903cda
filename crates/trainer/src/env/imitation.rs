//! How near a character is to a moment of a clip. What is compared is seen from the pelvis, so that neither place nor
//! heading matters, and nothing jumps where a pelvis points straight up or down and has no heading.

use glam::Vec3;
use policy_core::{BODY_COUNT, Body, CharacterState};

/// What is compared of a state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Likeness {
    /// Height of the pelvis above the ground, metres.
    height: f32,
    /// The vertical, seen from the pelvis.
    up: Vec3,
    /// Velocity of the pelvis, seen from it, metres per second.
    velocity: Vec3,
    /// Places of all bodies, seen from the pelvis, metres.
    places: [Vec3; BODY_COUNT],
    /// Their velocities beside the pelvis', seen from it, metres per second.
    velocities: [Vec3; BODY_COUNT],
}

/// A character is lost when its pelvis is this much higher or lower than the clip's, metres.
const LOST_HEIGHT_METRES: f32 = 0.35;

/// Or leans this much another way: length of the difference of the verticals seen from the pelvis (1 is 60 degrees).
const LOST_LEAN: f32 = 1.0;

impl Likeness {
    /// Of a state.
    #[must_use]
    pub fn of(state: &CharacterState) -> Self {
        let pelvis = state.body(Body::Pelvis);
        let seen = pelvis.rotation.inverse();
        Self {
            height: state.height_of(Body::Pelvis),
            up: seen * Vec3::Z,
            velocity: seen * pelvis.linear_velocity,
            places: state.bodies.each_ref().map(|b| seen * (b.position - pelvis.position)),
            velocities: state.bodies.each_ref().map(|b| seen * (b.linear_velocity - pelvis.linear_velocity)),
        }
    }

    /// Height of the pelvis above the ground, metres.
    #[must_use]
    pub fn pelvis_metres(&self) -> f32 {
        self.height
    }

    /// Reward in [0, 1] for being like `wanted`: 0.45 for the pose, 0.3 for height and lean of the pelvis, 0.25 for the
    /// velocities, each by exponentials of a distance and not of its square, so that far away still has a slope; a narrow one
    /// beside a wide one for pose and velocities, so that a slow gait can't be had by standing still.
    #[must_use]
    pub fn reward(&self, wanted: &Self) -> f32 {
        let apart = rms(&self.places, &wanted.places);
        let pose = 0.25 * (-apart / 0.2).exp() + 0.2 * (-apart / 0.06).exp();
        let trunk = (-(self.height - wanted.height).abs() / 0.3 - self.up.distance(wanted.up)).exp();
        let moving =
            rms(&self.velocities, &wanted.velocities) + 0.5 * self.velocity.distance(wanted.velocity);
        pose + 0.3 * trunk + 0.1 * (-moving / 3.0).exp() + 0.15 * (-moving / 0.6).exp()
    }

    /// True when it is so far from `wanted` that going on teaches nothing: its bodies, seen from the pelvis, more than `metres`
    /// in the root mean square, its pelvis at another height, or leaning another way.
    #[must_use]
    pub fn is_lost(&self, wanted: &Self, metres: f32) -> bool {
        rms(&self.places, &wanted.places) > metres
            || (self.height - wanted.height).abs() > LOST_HEIGHT_METRES
            || self.up.distance(wanted.up) > LOST_LEAN
    }
}

fn rms(a: &[Vec3], b: &[Vec3]) -> f32 {
    let sum: f32 = a.iter().zip(b).map(|(a, b)| a.distance_squared(*b)).sum();
    (sum / a.len() as f32).sqrt()
}

#[cfg(test)]
mod tests {
    use glam::Quat;

    use super::*;

    fn state(turn: Quat, shift: Vec3) -> CharacterState {
        let mut state = CharacterState::default();
        for (i, body) in state.bodies.iter_mut().enumerate() {
            let i = i as f32;
            body.position = turn * Vec3::new(0.1 * i, 0.3 - 0.05 * i, 0.02 * i) + shift + 0.8 * Vec3::Z;
            body.rotation = turn;
            body.linear_velocity = turn * Vec3::new(1.0, 0.1 * i, 0.0);
        }
        state
    }

    #[test]
    fn neither_place_nor_heading_matters() {
        let here = Likeness::of(&state(Quat::IDENTITY, Vec3::ZERO));
        let there = Likeness::of(&state(Quat::from_rotation_z(2.0), Vec3::new(3.0, -1.0, 0.0)));
        assert!((here.reward(&there) - 1.0).abs() < 1e-3, "{}", here.reward(&there));
        assert!(!here.is_lost(&there, 0.35));
    }

    #[test]
    fn height_lean_pose_and_velocity_each_cost() {
        let wanted = Likeness::of(&state(Quat::IDENTITY, Vec3::ZERO));
        let mut last = 1.0;
        for metres in [0.02, 0.1, 0.3, 0.5] {
            let reward = Likeness::of(&state(Quat::IDENTITY, metres * Vec3::Z)).reward(&wanted);
            assert!(reward < last - 0.01, "{reward} after {last}");
            last = reward;
        }
        let leaning = Likeness::of(&state(Quat::from_rotation_y(1.3), Vec3::ZERO));
        assert!(leaning.is_lost(&wanted, 0.35) && leaning.reward(&wanted) < 0.9);
        assert!(Likeness::of(&state(Quat::IDENTITY, 0.5 * Vec3::Z)).is_lost(&wanted, 0.35));
        let (mut bent, mut fast) = (state(Quat::IDENTITY, Vec3::ZERO), state(Quat::IDENTITY, Vec3::ZERO));
        bent.bodies[4].position.x += 0.5;
        fast.bodies[4].linear_velocity.x += 4.0;
        assert!(Likeness::of(&bent).reward(&wanted) < 0.8);
        // One body of fifteen half a metre off is 0.129 m in the root mean square.
        assert!(Likeness::of(&bent).is_lost(&wanted, 0.12) && !Likeness::of(&bent).is_lost(&wanted, 0.14));
        assert!(Likeness::of(&fast).reward(&wanted) < 0.95);
    }
}
