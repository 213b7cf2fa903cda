//! MuJoCo writes nothing into the working folder, whatever it has to warn of. Alone in its process, because
//! the working folder belongs to all of it.

mod common;

use common::{HUMANOID, humanoid};
use physics_bridge::{Character, Model};
use policy_core::JointTargets;

#[test]
fn warnings_and_errors_leave_no_file() {
    let folder = tempfile::tempdir().unwrap();
    std::env::set_current_dir(folder.path()).unwrap();
    assert!(Model::from_mjcf("<mujoco><geom/>").is_err());
    assert!(Model::from_mjcf(&HUMANOID.replace("hinge", "henge")).is_err());
    let mut character = Character::new(&humanoid());
    for _ in 0..3 {
        character.actuate(&JointTargets::from(vec![f32::NAN; 28]));
        assert!(character.step().is_err());
        let mut pose = character.pose();
        pose.qvel[10] = 1e9;
        character.set_pose(&pose.qpos, &pose.qvel).unwrap();
        assert!(character.step().is_err());
    }
    let left: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().path()).collect();
    assert!(left.is_empty(), "found {left:?}");
    std::env::set_current_dir("/").unwrap();
}
