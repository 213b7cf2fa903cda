//! Motion that blows up is caught, named, undone, and can be replayed from a file. MuJoCo leaves no file.

mod common;

use common::{HUMANOID, body, hash, humanoid, run};
use glam::Vec3;
use physics_bridge::{Cause, Character, Diverged, MAX_DEPTH_M, MAX_SPEED_MPS, Model, ReplayFile, Settings};
use policy_core::{BodyId, JointTargets};

fn index(joint: &str) -> usize {
    humanoid().skeleton().joint_named(joint).unwrap().index()
}

/// Steps once with a target that is not a number.
fn nan_in_the_knee() -> (Character, Diverged, u64) {
    let mut character = Character::new(&humanoid());
    run(&mut character, 5);
    let mut targets = JointTargets::new(character.model().skeleton());
    targets[index("left_knee")] = f32::NAN;
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
    assert_eq!(error.cause, Cause::BadControl);
    assert_eq!((error.tick, error.substep, error.body), (5, 0, Some(body(character.model(), "left_shin"))));
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
            matches!(error.cause, Cause::BadPosition | Cause::BadVelocity | Cause::BadAcceleration);
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
fn the_replay_file_diverges_in_the_same_way() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("diverged.json");
    let (_, target, _) = nan_in_the_knee();
    for error in [target, too_fast().step().unwrap_err()] {
        error.replay.save(&path).unwrap();
        let mut replayed = ReplayFile::load(&path).unwrap().to_character().unwrap();
        let again = replayed.step().unwrap_err();
        assert_eq!(again.cause, error.cause);
        assert_eq!((again.tick, again.substep, again.body), (error.tick, error.substep, error.body));
        assert_eq!(again.replay.to_bytes(), error.replay.to_bytes());
    }
}

#[test]
fn a_diverged_tick_is_not_recorded() {
    let mut character = Character::new(&humanoid());
    character.record_history(1.0);
    run(&mut character, 5);
    let newest = hash(&character);
    let targets = JointTargets::from(vec![f32::INFINITY; character.model().skeleton().joint_count()]);
    character.actuate(&targets);
    character.step().unwrap_err();
    assert_eq!(character.history_len(), 6);
    character.rewind_to(0).unwrap();
    assert_eq!(hash(&character), newest);
}

/// A character posed in a way that no character can move, and the cause that its step must name.
fn implausible() -> Vec<(Cause, Character)> {
    let posed = |change: &dyn Fn(&mut physics_bridge::Pose)| {
        let mut character = Character::new(&humanoid());
        let mut pose = character.pose();
        change(&mut pose);
        character.set_pose(&pose.qpos, &pose.qvel).unwrap();
        character
    };
    vec![
        (Cause::TooFast, posed(&|pose| pose.qvel[0] = 60.0)),
        (Cause::TooFast, posed(&|pose| (pose.qpos[2], pose.qvel[2]) = (100.0, 51.0))),
        (Cause::SpinsTooFast, posed(&|pose| (pose.qpos[2], pose.qvel[5]) = (5.0, 400.0))),
        (Cause::TooFarAway, posed(&|pose| pose.qpos[1] = -20_000.0)),
        (Cause::TooFarAway, posed(&|pose| pose.qpos[2] = 11_000.0)),
    ]
}

#[test]
fn motion_that_no_body_makes_is_a_divergence() {
    for (cause, mut character) in implausible() {
        let before = hash(&character);
        let error = character.step().unwrap_err();
        assert_eq!((error.cause, error.tick), (cause, 0), "{error}");
        assert!(error.body.is_some(), "{error}");
        let excess = error.excess.unwrap();
        assert!(excess.value > excess.limit, "{error}");
        let words = error.to_string();
        assert!(words.contains("pelvis") && words.contains(&excess.limit.to_string()), "{words}");
        assert_eq!(hash(&character), before, "the character is back where it was");
        let again = ReplayFile::from_bytes(&error.replay.to_bytes()).unwrap().to_character().unwrap().step();
        assert_eq!(again.unwrap_err().cause, cause);
        character.stand_at(0.0, 0.0, policy_core::Heading::FORWARD, 0.0).unwrap();
        run(&mut character, 3);
    }
}

/// A character that touches nothing falls through the ground.
#[test]
fn falling_through_the_ground_is_a_divergence() {
    let ghost = [(1, 0), (5, 2), (3, 4)].iter().fold(HUMANOID.to_owned(), |mjcf, (contype, conaffinity)| {
        let solid = format!("contype=\"{contype}\" conaffinity=\"{conaffinity}\"");
        assert!(mjcf.contains(&solid), "{solid}");
        mjcf.replace(&solid, "contype=\"0\" conaffinity=\"0\"")
    });
    let mut character = Character::new(&Model::from_mjcf(&ghost).unwrap());
    let error = (0..60).find_map(|_| character.step().err()).expect("it falls through");
    assert_eq!(error.cause, Cause::BelowGround, "{error}");
    let excess = error.excess.unwrap();
    assert!((MAX_DEPTH_M..MAX_DEPTH_M + 0.3).contains(&excess.value), "caught within a tick: {error}");
}

/// A shove that is repeated before the last one has worn off drove a character to a thousand kilometres a
/// second before there was a bound.
#[test]
fn repeated_shoves_do_not_add_up() {
    for (force, every) in [(1200.0, 10), (1200.0, 1), (20_000.0, 3)] {
        let mut character = Character::new(&humanoid());
        let (torso, bodies) = (body(character.model(), "torso"), character.model().skeleton().body_count());
        let mut diverged = 0;
        for tick in 0..1800 {
            if tick % every == 0 {
                character.push(torso, Vec3::X * force, 0.2).unwrap();
                assert!(character.is_pushed(torso));
            }
            if character.step().is_err() {
                diverged += 1;
                let pose = character.pose();
                let (x, y) = (pose.qpos[0] as f32, pose.qpos[1] as f32);
                character.stand_at(x, y, policy_core::Heading::FORWARD, 0.0).unwrap();
            }
            let speed = (0..bodies).map(|b| character.speed_of(BodyId::new(b))).fold(0.0, f32::max);
            assert!(speed <= MAX_SPEED_MPS, "{speed} m/s at tick {tick}");
        }
        assert!(diverged < 10 || force > 1200.0, "{diverged} divergences under {force} N");
    }
}

#[test]
fn a_push_drives_a_body_only_so_fast() {
    let weightless = Settings { gravity: 0.0, strength: 0.0, ..Settings::default() };
    let model = humanoid().with_settings(weightless).unwrap();
    let speeds = [100.0, 1000.0].map(|force| {
        let mut character = Character::new(&model);
        let mut pose = character.pose();
        pose.qpos[2] += 100.0;
        character.set_pose(&pose.qpos, &pose.qvel).unwrap();
        character.push(model.skeleton().root(), Vec3::X * force, 60.0).unwrap();
        for _ in 0..900 {
            character.step().unwrap();
        }
        character.impulse(model.skeleton().root(), Vec3::X * 1000.0).unwrap();
        character.step().unwrap();
        character.centre_of_mass_velocity().x
    });
    assert!(speeds.iter().all(|speed| (15.0..22.0).contains(speed)), "{speeds:?}");
}
