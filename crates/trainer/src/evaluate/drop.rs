//! A character that is dropped limp, to see it get up.

use glam::{EulerRot, Quat, Vec2};
use physics_bridge::{Character, Pose};
use policy_core::JointTargets;

use crate::Rng;
use crate::env::DT_SECS;

/// Height of the root above the ground from which it is dropped, metres.
const DROP_METRES: f32 = 0.8;

/// Seconds in which it comes to rest.
const REST_SECS: f32 = 2.0;

/// Drops a character in a random attitude at a place, metres, limp, and lets it come to rest for two seconds. False when the
/// physics diverged.
pub(super) fn drop_limp(character: &mut Character, place: Vec2, rng: &mut Rng) -> bool {
    let turn = Quat::from_euler(EulerRot::ZYX, rng.angle(), rng.range(-1.6, 1.6), rng.angle());
    let skeleton = character.model().skeleton().clone();
    let mut pose = Pose::new(&skeleton);
    let height = character.model().height_at(place.x, place.y) + DROP_METRES;
    pose.qpos[..3].copy_from_slice(&[place.x, place.y, height].map(f64::from));
    pose.qpos[3..7].copy_from_slice(&[turn.w, turn.x, turn.y, turn.z].map(f64::from));
    for (angle, joint) in pose.qpos[7..].iter_mut().zip(skeleton.joints()) {
        *angle = f64::from(0.5 * rng.range(joint.range[0], joint.range[1]));
    }
    if character.set_pose(&pose.qpos, &pose.qvel).is_err() {
        return false;
    }
    let mut targets = JointTargets::new(&skeleton);
    for _ in 0..(REST_SECS / DT_SECS) as u32 {
        character.pose_into(&mut pose);
        for (target, angle) in targets.iter_mut().zip(&pose.qpos[7..]) {
            *target = *angle as f32;
        }
        character.actuate(&targets);
        if character.step().is_err() {
            return false;
        }
    }
    true
}
