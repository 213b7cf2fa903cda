//! A character that stands still breathes. That is drawn only: the physics knows nothing of it.

use glam::{Quat, Vec3};
use physics_bridge::BodyPoses;
use policy_core::{BodyId, Skeleton};

/// Seconds of a breath.
const BREATH_SECS: f32 = 3.8;
/// How far the chest leans back and rises, radians and metres, to each side of its rest.
const LEANS: f32 = 0.016;
const RISES_M: f32 = 0.004;
/// Above the first speed it does not show, below the other wholly, metres per second.
const SPEEDS_MPS: [f32; 2] = [0.45, 0.12];

/// How much of it shows at a speed, 0 to 1.
pub(crate) fn share_at(speed_mps: f32) -> f32 {
    let [none, all] = SPEEDS_MPS;
    let share = ((none - speed_mps) / (none - all)).clamp(0.0, 1.0);
    share * share * (3.0 - 2.0 * share)
}

/// Moves the chest and what hangs on it at a time, seconds. `share` is 0 for none and 1 for all of it.
pub(crate) fn breathe(poses: &mut BodyPoses, skeleton: &Skeleton, secs: f32, share: f32) {
    let Some(chest) = skeleton.head().and_then(|head| skeleton.parent(head)) else { return };
    let wave = share * (std::f32::consts::TAU * (secs / BREATH_SECS).fract()).sin();
    if wave == 0.0 {
        return;
    }
    let pivot = poses.positions[chest.index()];
    let across = poses.rotations[chest.index()] * Vec3::Y;
    let turn = Quat::from_axis_angle(across.normalize_or(Vec3::Y), -LEANS * wave);
    for index in 0..poses.positions.len() {
        if hangs_on(skeleton, BodyId::new(index), chest) {
            poses.positions[index] =
                pivot + turn * (poses.positions[index] - pivot) + Vec3::Z * (RISES_M * wave);
            poses.rotations[index] = turn * poses.rotations[index];
        }
    }
}

/// True for a body and all that its joints carry.
fn hangs_on(skeleton: &Skeleton, mut body: BodyId, on: BodyId) -> bool {
    loop {
        if body == on {
            return true;
        }
        match skeleton.parent(body) {
            Some(parent) => body = parent,
            None => return false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::{SimConfig, Simulation};

    #[test]
    fn the_chest_moves_a_little_and_the_feet_not_at_all() {
        let pack = policy_core::CharacterPack::from_bytes(crate::assets::HUMANOID_PACK).unwrap();
        let sim = Simulation::new(std::sync::Arc::new(pack), SimConfig::default()).unwrap();
        let skeleton = sim.pack().skeleton();
        let at = |secs: f32, share: f32| {
            let mut poses = sim.poses(0, 1.0);
            breathe(&mut poses, skeleton, secs, share);
            poses
        };
        let (still, full) = (at(0.0, 1.0), at(0.25 * BREATH_SECS, 1.0));
        assert_eq!(still.positions, sim.poses(0, 1.0).positions);
        let moved = |body: BodyId| full.positions[body.index()].distance(still.positions[body.index()]);
        let head = moved(skeleton.head().unwrap());
        assert!((0.003..0.03).contains(&head), "{head}");
        assert!(skeleton.feet().iter().all(|foot| moved(*foot) == 0.0));
        assert_eq!(at(1.0, 0.0).positions, still.positions, "none while it moves");
    }

    #[test]
    fn it_shows_at_rest_and_fades_with_speed() {
        assert_eq!([share_at(0.0), share_at(2.0)], [1.0, 0.0]);
        assert!(share_at(0.2) > share_at(0.3));
    }
}
