//! Tracking error: how far a character is from a phase of a clip. Everything is seen from the root, so neither position nor
//! heading matters, and nothing jumps where a root points straight up or down and has no heading.

use glam::Vec3;
use policy_core::CharacterState;

/// What tracking compares of a state.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackedState {
    /// Height of the root above the ground, metres.
    height: f32,
    /// The vertical, seen from the root.
    up: Vec3,
    /// Velocity of the root, seen from it, metres per second.
    velocity: Vec3,
    /// Positions of all bodies, seen from the root, metres.
    positions: Vec<Vec3>,
    /// Their velocities relative to the root's, seen from it, metres per second.
    velocities: Vec<Vec3>,
}

/// Early-termination threshold of the root's height, metres.
const MAX_HEIGHT_ERROR_METRES: f32 = 0.35;

/// Early-termination threshold of the lean: length of the difference of the verticals seen from the root (1 is 60 degrees).
const MAX_LEAN_ERROR: f32 = 1.0;

impl TrackedState {
    /// Of a state.
    #[must_use]
    pub fn of(state: &CharacterState) -> Self {
        let root = state.root();
        let seen = root.rotation.inverse();
        Self {
            height: state.root_height(),
            up: seen * Vec3::Z,
            velocity: seen * root.linear_velocity,
            positions: state.bodies.iter().map(|b| seen * (b.position - root.position)).collect(),
            velocities: state
                .bodies
                .iter()
                .map(|b| seen * (b.linear_velocity - root.linear_velocity))
                .collect(),
        }
    }

    /// Height of the root above the ground, metres.
    #[must_use]
    pub fn root_metres(&self) -> f32 {
        self.height
    }

    /// Tracking reward in [0, 1]: 0.45 for the pose, 0.3 for height and lean of the root, 0.25 for the velocities.
    ///
    /// Each is a sum of exponentials of a distance, not of its square, so that far away still has a slope. Pose and velocities
    /// have a narrow one beside a wide one, so that a slow gait can't be had by standing still.
    #[must_use]
    pub fn reward(&self, wanted: &Self) -> f32 {
        let apart = rms(&self.positions, &wanted.positions);
        let pose = 0.25 * (-apart / 0.2).exp() + 0.2 * (-apart / 0.06).exp();
        let trunk = (-(self.height - wanted.height).abs() / 0.3 - self.up.distance(wanted.up)).exp();
        let moving =
            rms(&self.velocities, &wanted.velocities) + 0.5 * self.velocity.distance(wanted.velocity);
        pose + 0.3 * trunk + 0.1 * (-moving / 3.0).exp() + 0.15 * (-moving / 0.6).exp()
    }

    /// True when the tracking error exceeds its threshold: bodies more than `metres` away in the root mean square, seen from the
    /// root, or the root at another height or leaning another way.
    #[must_use]
    pub fn exceeds(&self, wanted: &Self, metres: f32) -> bool {
        rms(&self.positions, &wanted.positions) > metres
            || (self.height - wanted.height).abs() > MAX_HEIGHT_ERROR_METRES
            || self.up.distance(wanted.up) > MAX_LEAN_ERROR
    }
}

fn rms(a: &[Vec3], b: &[Vec3]) -> f32 {
    let sum: f32 = a.iter().zip(b).map(|(a, b)| a.distance_squared(*b)).sum();
    (sum / a.len() as f32).sqrt()
}

#[cfg(test)]
mod tests {
    use glam::Quat;
    use policy_core::Skeleton;

    use super::*;

    fn state(turn: Quat, shift: Vec3) -> CharacterState {
        let mut state = CharacterState::new(&Skeleton::humanoid());
        for (i, body) in state.bodies.iter_mut().enumerate() {
            let i = i as f32;
            body.position = turn * Vec3::new(0.1 * i, 0.3 - 0.05 * i, 0.02 * i) + shift + 0.8 * Vec3::Z;
            body.rotation = turn;
            body.linear_velocity = turn * Vec3::new(1.0, 0.1 * i, 0.0);
        }
        state
    }

    #[test]
    fn neither_position_nor_heading_matters() {
        let here = TrackedState::of(&state(Quat::IDENTITY, Vec3::ZERO));
        let there = TrackedState::of(&state(Quat::from_rotation_z(2.0), Vec3::new(3.0, -1.0, 0.0)));
        assert!((here.reward(&there) - 1.0).abs() < 1e-3, "{}", here.reward(&there));
        assert!(!here.exceeds(&there, 0.35));
    }

    #[test]
    fn height_lean_pose_and_velocity_each_cost() {
        let wanted = TrackedState::of(&state(Quat::IDENTITY, Vec3::ZERO));
        let mut last = 1.0;
        for metres in [0.02, 0.1, 0.3, 0.5] {
            let reward = TrackedState::of(&state(Quat::IDENTITY, metres * Vec3::Z)).reward(&wanted);
            assert!(reward < last - 0.01, "{reward} after {last}");
            last = reward;
        }
        let leaning = TrackedState::of(&state(Quat::from_rotation_y(1.3), Vec3::ZERO));
        assert!(leaning.exceeds(&wanted, 0.35) && leaning.reward(&wanted) < 0.9);
        assert!(TrackedState::of(&state(Quat::IDENTITY, 0.5 * Vec3::Z)).exceeds(&wanted, 0.35));
        let (mut bent, mut fast) = (state(Quat::IDENTITY, Vec3::ZERO), state(Quat::IDENTITY, Vec3::ZERO));
        bent.bodies[4].position.x += 0.5;
        fast.bodies[4].linear_velocity.x += 4.0;
        assert!(TrackedState::of(&bent).reward(&wanted) < 0.8);
        // One body of fifteen half a metre off is 0.129 m in the root mean square.
        assert!(
            TrackedState::of(&bent).exceeds(&wanted, 0.12) && !TrackedState::of(&bent).exceeds(&wanted, 0.14)
        );
        assert!(TrackedState::of(&fast).reward(&wanted) < 0.95);
    }
}
