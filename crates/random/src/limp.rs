//! Limp characters: dropped in a random attitude, with motors that follow the joints.

use glam::{EulerRot, Quat, Vec2};
use policy_core::contract::{PhysicsCharacter, Pose, PoseError};

use crate::Rng;

/// A random attitude: any heading, any roll, tipped by at most about 90 degrees.
#[must_use]
pub fn random_attitude(rng: &mut Rng) -> Quat {
    Quat::from_euler(EulerRot::ZYX, rng.angle(), rng.range(-1.6, 1.6), rng.angle())
}

/// Height from which a character is dropped: that of its root above the ground, metres.
pub const DROP_METRES: f32 = 0.8;

/// Seconds in which a dropped character comes to rest.
pub const REST_SECS: f32 = 2.0;

/// Puts a character at rest in a random attitude with its root [`DROP_METRES`] above the ground at a place, metres. Joints are
/// anywhere in the middle halves of their ranges.
///
/// # Errors
/// When the place is not finite.
pub fn lift_anyhow(
    character: &mut impl PhysicsCharacter,
    place: Vec2,
    rng: &mut Rng,
) -> Result<(), PoseError> {
    let skeleton = character.skeleton().clone();
    let height = character.height_at(place.x, place.y) + DROP_METRES;
    let turn = random_attitude(rng);
    let mut pose = Pose::new(&skeleton);
    pose.qpos[..3].copy_from_slice(&[place.x, place.y, height].map(f64::from));
    pose.qpos[3..7].copy_from_slice(&[turn.w, turn.x, turn.y, turn.z].map(f64::from));
    for (angle, joint) in pose.qpos[7..].iter_mut().zip(skeleton.joints()) {
        *angle = f64::from(0.5 * rng.range(joint.range[0], joint.range[1]));
    }
    character.set_pose(&pose.qpos, &pose.qvel)
}

/// Drops a limp character in a random attitude at a place, metres, and steps it until it has come to rest, for
/// [`REST_SECS`]. False when the physics diverged or the place is not finite.
#[must_use]
pub fn drop_limp(character: &mut impl PhysicsCharacter, place: Vec2, rng: &mut Rng) -> bool {
    if lift_anyhow(character, place, rng).is_err() {
        return false;
    }
    let ticks = (REST_SECS * character.control_hz()).round() as u32;
    (0..ticks).all(|_| {
        go_limp(character);
        character.step().is_ok()
    })
}

/// Sets targets that follow the joints: nearly no torque but the joints' damping.
pub fn go_limp(character: &mut impl PhysicsCharacter) {
    let targets: Vec<f32> = character.pose().qpos[7..].iter().map(|angle| *angle as f32).collect();
    character.actuate(&targets);
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use physics_bridge::{Character, Model};
    use policy_core::CharacterState;

    use super::*;

    #[test]
    fn a_limp_character_comes_to_lie_where_it_is_dropped() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/humanoid.xml");
        let model = Model::load(path).unwrap();
        let mut character = Character::new(&model);
        let mut state = CharacterState::new(model.skeleton());
        let mut rng = Rng::new(3, 1);
        let place = Vec2::new(4.0, -3.0);
        for _ in 0..4 {
            assert!(drop_limp(&mut character, place, &mut rng));
            character.sense_into(&mut state);
            assert!(state.root_height() < 0.4, "{}", state.root_height());
            assert!(state.root().position.truncate().distance(place) < 2.0, "{:?}", state.root());
        }
    }

    #[test]
    fn a_place_that_is_none_is_refused() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/humanoid.xml");
        let mut character = Character::new(&Model::load(path).unwrap());
        let mut rng = Rng::new(3, 1);
        assert!(lift_anyhow(&mut character, Vec2::new(f32::NAN, 0.0), &mut rng).is_err());
        assert!(!drop_limp(&mut character, Vec2::new(0.0, f32::INFINITY), &mut rng));
    }
}
