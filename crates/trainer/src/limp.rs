//! Limp characters: dropped in a random attitude, with motors that follow the joints.

use glam::{EulerRot, Quat};
use physics_bridge::{Character, Pose, PoseError};

use crate::Rng;

/// A random attitude: any heading, any roll, tipped by at most about 90 degrees.
#[must_use]
pub fn random_attitude(rng: &mut Rng) -> Quat {
    Quat::from_euler(EulerRot::ZYX, rng.angle(), rng.range(-1.6, 1.6), rng.angle())
}

/// Puts a character at rest in a random attitude with its root over the origin at this height, metres. Joints are anywhere in the
/// middle halves of their ranges.
///
/// # Errors
/// When the height is not finite.
pub fn lift_anyhow(character: &mut Character, metres: f32, rng: &mut Rng) -> Result<(), PoseError> {
    let skeleton = character.model().skeleton().clone();
    let turn = random_attitude(rng);
    let mut pose = Pose::new(&skeleton);
    pose.qpos[2] = f64::from(metres);
    pose.qpos[3..7].copy_from_slice(&[turn.w, turn.x, turn.y, turn.z].map(f64::from));
    for (angle, joint) in pose.qpos[7..].iter_mut().zip(skeleton.joints()) {
        *angle = f64::from(0.5 * rng.range(joint.range[0], joint.range[1]));
    }
    character.set_pose(&pose.qpos, &pose.qvel)
}

/// Sets targets that follow the joints: nearly no torque but the joints' damping.
pub fn go_limp(character: &mut Character) {
    let targets: Vec<f32> = character.pose().qpos[7..].iter().map(|angle| *angle as f32).collect();
    character.actuate(&targets);
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use physics_bridge::Model;
    use policy_core::CharacterState;

    use super::*;

    #[test]
    fn a_limp_character_comes_to_lie() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/humanoid.xml");
        let model = Model::load(path).unwrap();
        let mut character = Character::new(&model);
        let mut state = CharacterState::new(model.skeleton());
        let mut rng = Rng::new(3, 1);
        for _ in 0..4 {
            lift_anyhow(&mut character, 0.8, &mut rng).unwrap();
            for _ in 0..90 {
                go_limp(&mut character);
                character.step().unwrap();
            }
            character.sense_into(&mut state);
            assert!(state.root_height() < 0.4, "{}", state.root_height());
        }
        assert!(lift_anyhow(&mut character, f32::NAN, &mut rng).is_err());
    }
}
