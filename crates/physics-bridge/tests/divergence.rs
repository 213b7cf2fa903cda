//! Motion that blows up is caught, named, undone, and can be replayed from a file. MuJoCo leaves no file.

mod common;

use common::{hash, humanoid, run};
use physics_bridge::{Character, Diverged, Dump, Warning};
use policy_core::{Body, JOINT_NAMES, JointTargets};

fn index(joint: &str) -> usize {
    JOINT_NAMES.iter().position(|&name| name == joint).unwrap()
}

/// Steps once with a target that is not a number.
fn nan_in_the_knee() -> (Character, Diverged, u64) {
    let mut character = Character::new(&humanoid());
    run(&mut character, 5);
    let mut targets = JointTargets::default();
    targets.0[index("left_knee")] = f32::NAN;
    character.actuate(&targets);
    let before = hash(&character);
    let error = character.step().unwrap_err();
    (character, error, before)
}

/// One joint spins faster than the integrator can follow.
fn too_fast() -> Character {
    let mut character = Character::new(&humanoid());
    let mut pose = character.pose();
    pose.qpos[2] += 5.0;
    pose.qvel[6 + index("right_elbow")] = 1e9;
    character.set_pose(&pose.qpos, &pose.qvel).unwrap();
    character
}

#[test]
fn a_target_that_is_no_number_is_named() {
    let (character, error, before) = nan_in_the_knee();
    assert_eq!(error.warning, Warning::BadControl);
    assert_eq!((error.tick, error.substep, error.body), (5, 0, Some(Body::LeftShin)));
    let words = error.to_string();
    assert!(words.contains("tick 5") && words.contains("left_shin"), "{words}");
    assert_eq!(hash(&character), before, "the character is back where it was");
    assert_eq!(character.tick(), 5);
}

#[test]
fn it_goes_on_after_a_good_target() {
    let (mut character, _, _) = nan_in_the_knee();
    let mut other = Character::new(character.model());
    run(&mut other, 5);
    run(&mut character, 30);
    run(&mut other, 30);
    assert_eq!(hash(&character), hash(&other), "nothing is left of the failure");
}

#[test]
fn motion_that_is_too_fast_is_caught_again_and_again() {
    let mut character = too_fast();
    let before = hash(&character);
    for _ in 0..3 {
        let error = character.step().unwrap_err();
        let expected =
            matches!(error.warning, Warning::BadPosition | Warning::BadVelocity | Warning::BadAcceleration);
        assert!(expected && error.body.is_some(), "{error}");
        assert_eq!(hash(&character), before);
    }
    character.stand_at(0.0, 0.0, policy_core::Heading::FORWARD, 0.0).unwrap();
    let mut other = Character::new(character.model());
    run(&mut character, 10);
    run(&mut other, 10);
    assert_eq!(hash(&character), hash(&other));
}

#[test]
fn the_dump_diverges_in_the_same_way() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("diverged.json");
    let (_, target, _) = nan_in_the_knee();
    for error in [target, too_fast().step().unwrap_err()] {
        error.dump.save(&path).unwrap();
        let mut replayed = Dump::load(&path).unwrap().to_character().unwrap();
        let again = replayed.step().unwrap_err();
        assert_eq!(again.warning, error.warning);
        assert_eq!((again.tick, again.substep, again.body), (error.tick, error.substep, error.body));
        assert_eq!(again.dump.to_bytes(), error.dump.to_bytes());
    }
}

#[test]
fn a_diverged_tick_is_not_recorded() {
    let mut character = Character::new(&humanoid());
    character.record_history(1.0);
    run(&mut character, 5);
    let newest = hash(&character);
    character.actuate(&JointTargets([f32::INFINITY; 28]));
    character.step().unwrap_err();
    assert_eq!(character.history_len(), 6);
    character.rewind_to(0).unwrap();
    assert_eq!(hash(&character), newest);
}
