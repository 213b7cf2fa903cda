//! The same character in MuJoCo. What MuJoCo does was written once by the program in `golden/`.

mod common;

use common::{humanoid, joint};
use physics_rapier::{Character, Drive, Model};
use policy_core::CharacterState;
use serde_json::Value;

/// Numbers of the root in `qpos`.
const ROOT: usize = 7;

fn golden() -> Value {
    serde_json::from_str(include_str!("golden/humanoid.json")).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|n| n.as_f64().unwrap()).collect()
}

fn singles(value: &Value) -> Vec<f32> {
    numbers(value).iter().map(|&n| n as f32).collect()
}

/// A character in the pose that `value` names `before`, which also knows its targets.
fn start(model: &Model, drive: Drive, value: &Value) -> Character {
    let mut character = Character::with_drive(model, drive);
    let before = &value["before"];
    character.set_pose(&numbers(&before["qpos"]), &numbers(&before["qvel"])).unwrap();
    if value["targets"].is_array() {
        character.actuate(&singles(&value["targets"]));
    }
    character
}

fn steps(character: &mut Character, ticks: usize) {
    (0..ticks).for_each(|_| character.step().unwrap());
}

/// Largest difference of two lists.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn it_falls_and_tumbles_as_in_mujoco() {
    let fall = &golden()["free_fall"];
    let mut character = start(&humanoid(), Drive::Torques, fall);
    steps(&mut character, 15);
    let (pose, after) = (character.pose(), &fall["after"]);
    let (qpos, qvel) = (numbers(&after["qpos"]), numbers(&after["qvel"]));
    let place = apart(&pose.qpos[..3], &qpos[..3]);
    let turn = apart(&pose.qpos[3..7], &qpos[3..7]);
    let angles = apart(&pose.qpos[ROOT..], &qpos[ROOT..]);
    let speeds = apart(&pose.qvel, &qvel);
    println!("place {place} m, quaternion {turn}, hinges {angles} rad, velocities {speeds}");
    assert!(place < 5e-3 && turn < 5e-3 && angles < 5e-3 && speeds < 5e-2);
}

#[test]
fn joints_respond_as_in_mujoco() {
    let model = humanoid();
    for response in golden()["responses"].as_array().unwrap() {
        let name = response["joint"].as_str().unwrap();
        let index = ROOT + joint(&model, name).index();
        let worst_with = |drive| {
            let mut character = start(&model, drive, response);
            let first = character.pose().qpos[index];
            let angles = numbers(&response["angles"]);
            let differences = angles.iter().map(|angle| {
                character.step().unwrap();
                (character.pose().qpos[index] - first - angle).abs()
            });
            differences.fold(0.0, f64::max)
        };
        let (torques, motors) = (worst_with(Drive::Torques), worst_with(Drive::Motors));
        println!("{name}: {torques:.5} rad with torques, {motors:.5} rad with motors, of 0.3");
        assert!(torques < 5e-4, "{name}: {torques}");
        assert!(motors < 0.05, "{name}: {motors}");
    }
}

/// Trap: Rapier's limits are all but rigid, MuJoCo's are soft.
#[test]
fn limits_give_way_as_in_mujoco() {
    let limit = &golden()["limit"];
    let model = humanoid();
    let mut character = start(&model, Drive::Torques, limit);
    let knee = ROOT + joint(&model, "right_knee").index();
    let pairs: Vec<(f64, f64)> = numbers(&limit["angles"])
        .into_iter()
        .map(|angle| {
            character.step().unwrap();
            (angle, character.pose().qpos[knee])
        })
        .collect();
    println!("{pairs:.4?}");
    let worst = pairs.iter().map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let (mujoco, rapier) = pairs[pairs.len() - 1];
    println!("at worst {worst:.4} rad, at last {mujoco:.4} and {rapier:.4} rad");
    // MuJoCo overshoots more, and both come to rest in one place. A rigid limit would hold it at 0.
    assert!(worst < 0.1 && (mujoco - rapier).abs() < 0.012);
}

#[test]
fn it_lands_as_in_mujoco() {
    let drop = &golden()["drop"];
    let mut character = start(&humanoid(), Drive::Torques, drop);
    let heights = numbers(&drop["heights"]);
    let mut worst: f64 = 0.0;
    for height in &heights {
        character.step().unwrap();
        worst = worst.max((character.pose().qpos[2] - height).abs());
    }
    let last = (character.pose().qpos[2] - heights[heights.len() - 1]).abs();
    println!("at worst {worst} m, at last {last} m");
    assert!(worst < 0.02 && last < 0.005);
}

#[test]
fn it_senses_as_in_mujoco() {
    let model = humanoid();
    let mut state = CharacterState::new(model.skeleton());
    for tick in golden()["walk"].as_array().unwrap() {
        start(&model, Drive::Torques, tick).sense_into(&mut state);
        let found: Vec<f64> = state
            .bodies
            .iter()
            .flat_map(|b| {
                let (p, q, v, w) = (b.position, b.rotation, b.linear_velocity, b.angular_velocity);
                [p.x, p.y, p.z, q.x, q.y, q.z, q.w, v.x, v.y, v.z, w.x, w.y, w.z].map(f64::from)
            })
            .collect();
        let expected = numbers(&tick["bodies"]);
        for (found, expected) in found.chunks(13).zip(expected.chunks(13)) {
            assert!(apart(&found[..3], &expected[..3]) < 1e-5);
            let same = apart(&found[3..7], &expected[3..7]);
            let negated: Vec<f64> = expected[3..7].iter().map(|n| -n).collect();
            assert!(same.min(apart(&found[3..7], &negated)) < 1e-5);
            assert!(apart(&found[7..], &expected[7..]) < 1e-3);
        }
    }
}

#[test]
fn a_tick_of_walking_ends_as_in_mujoco() {
    let model = humanoid();
    let ticks = golden();
    let ticks = ticks["walk"].as_array().unwrap();
    let (mut angles, mut places, mut worst_place) = (0.0, 0.0, 0.0_f64);
    for tick in ticks {
        let mut character = start(&model, Drive::Torques, tick);
        character.step().unwrap();
        let (pose, after) = (character.pose(), numbers(&tick["after"]["qpos"]));
        let hinges = pose.qpos[ROOT..].iter().zip(&after[ROOT..]);
        angles += hinges.map(|(a, b)| (a - b).powi(2)).sum::<f64>() / (after.len() - ROOT) as f64;
        let place = apart(&pose.qpos[..3], &after[..3]);
        places += place * place;
        worst_place = worst_place.max(place);
    }
    let count = ticks.len() as f64;
    let (angles, places) = ((angles / count).sqrt(), (places / count).sqrt());
    println!(
        "rms over {count} ticks: hinges {angles:.4} rad, root {places:.5} m, at worst {worst_place:.5} m"
    );
    assert!(angles < 0.015 && places < 0.005 && worst_place < 0.01);
}
