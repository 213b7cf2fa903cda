//! Writes what MuJoCo makes of the humanoid: the golden values of `tests/mujoco.rs`. Run it again when
//! `assets/humanoid.xml` changes. The poses of a walk come from the pack of the day and are stored with the rest, so
//! the tests do not depend on it.
//!
//! `cargo run --release -- ../tests/golden/humanoid.json`, with MUJOCO_DYNAMIC_LINK_DIR set.

use std::error::Error;
use std::sync::Arc;

use physics_bridge::{Character, Model, Pose, WALKING_START_MPS};
use policy_core::glam::Vec2;
use policy_core::{CharacterPack, CharacterState, Command, Controller, ControllerConfig, Goal, Heading};
use serde_json::{Value, json};

const ASSETS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../assets");
const RESPONDING: [&str; 6] =
    ["right_knee", "right_hip_y", "abdomen_y", "left_shoulder_x", "left_ankle_y", "neck_y"];
/// Numbers of the root in `qpos`.
const ROOT: usize = 7;

fn main() -> Result<(), Box<dyn Error>> {
    let to = std::env::args().nth(1).ok_or("expected the file to write")?;
    let pack = CharacterPack::from_bytes(&std::fs::read(format!("{ASSETS}/humanoid.pack.safetensors"))?)?;
    let mjcf = std::fs::read_to_string(format!("{ASSETS}/humanoid.xml"))?;
    let model = Model::from_mjcf_with_skeleton(&mjcf, pack.skeleton().clone())?;
    let responses = RESPONDING.map(|name| response(&model, name));
    let golden = json!({
        "free_fall": free_fall(&model),
        "responses": responses,
        "limit": limit(&model),
        "drop": drop_by(&model, 0.1),
        "walk": walk(&model, Arc::new(pack))?,
    });
    Ok(std::fs::write(to, serde_json::to_string(&golden)? + "\n")?)
}

fn single(numbers: &[f64]) -> Vec<f32> {
    numbers.iter().map(|&n| n as f32).collect()
}

fn pose(pose: &Pose) -> Value {
    json!({ "qpos": single(&pose.qpos), "qvel": single(&pose.qvel) })
}

/// The standing pose far above the ground.
fn aloft(model: &Model) -> (Character, Pose) {
    let character = Character::new(model);
    let mut pose = character.pose();
    pose.qpos[2] = 100.0;
    (character, pose)
}

/// It tumbles while the motors hold its pose: before, and after 15 ticks.
fn free_fall(model: &Model) -> Value {
    let (mut character, mut start) = aloft(model);
    start.qvel[..6].copy_from_slice(&[1.0, 0.5, 2.0, 0.5, 2.0, 1.0]);
    character.set_pose(&start.qpos, &start.qvel).unwrap();
    (0..15).for_each(|_| character.step().unwrap());
    json!({ "before": pose(&start), "after": pose(&character.pose()) })
}

/// One target steps by 0.3 rad in free fall: the joint's angle after each of 24 ticks, less that at the start.
fn response(model: &Model, name: &str) -> Value {
    let (mut character, start) = aloft(model);
    character.set_pose(&start.qpos, &start.qvel).unwrap();
    let joint = ROOT + model.skeleton().joint_named(name).unwrap().index();
    let mut targets: Vec<f32> = single(&start.qpos[ROOT..]);
    targets[joint - ROOT] += 0.3;
    character.actuate(&targets);
    let angles: Vec<f32> = (0..24)
        .map(|_| {
            character.step().unwrap();
            (character.pose().qpos[joint] - start.qpos[joint]) as f32
        })
        .collect();
    json!({ "joint": name, "before": pose(&start), "targets": targets, "angles": angles })
}

/// The right knee is pulled 0.5 rad beyond its straight limit in free fall: its angle after each of 15 ticks.
fn limit(model: &Model) -> Value {
    let (mut character, start) = aloft(model);
    character.set_pose(&start.qpos, &start.qvel).unwrap();
    let joint = model.skeleton().joint_named("right_knee").unwrap().index();
    let mut targets: Vec<f32> = single(&start.qpos[ROOT..]);
    targets[joint] = -0.5;
    character.actuate(&targets);
    let angles: Vec<f32> = (0..15)
        .map(|_| {
            character.step().unwrap();
            character.pose().qpos[ROOT + joint] as f32
        })
        .collect();
    json!({ "before": pose(&start), "targets": targets, "angles": angles })
}

/// Dropped on its feet while the motors hold its pose: the height of the root after each of 15 ticks.
fn drop_by(model: &Model, metres: f64) -> Value {
    let mut character = Character::new(model);
    let mut start = character.pose();
    start.qpos[2] += metres;
    character.set_pose(&start.qpos, &start.qvel).unwrap();
    let heights: Vec<f32> = (0..15)
        .map(|_| {
            character.step().unwrap();
            character.pose().qpos[2] as f32
        })
        .collect();
    json!({ "before": pose(&start), "heights": heights })
}

/// Ticks of a walk: the pose before, what is sensed of it, the targets, the pose after one control tick.
fn walk(model: &Model, pack: Arc<CharacterPack>) -> Result<Vec<Value>, Box<dyn Error>> {
    let walk = pack.graph().node_named("walk").ok_or("expected a node walk")?;
    let config = ControllerConfig { start: walk, auto_recover: false, ..ControllerConfig::default() };
    let mut controller = Controller::with_config(pack, config);
    let mut character = Character::new(model);
    character.stand_at(0.0, 0.0, Heading::FORWARD, WALKING_START_MPS)?;
    let mut state = CharacterState::new(model.skeleton());
    let mut ticks = Vec::new();
    for tick in 0..150 {
        let before = character.pose();
        character.sense_into(&mut state);
        let target = Some(state.root().position.truncate() + Vec2::new(5.0, 0.0));
        let command = Command { target, goal: Goal::Node(walk), ..Command::default() };
        character.control_tick(&mut controller, &command, 1.0 / model.control_hz())?;
        if tick >= 60 && tick % 9 == 0 {
            let bodies: Vec<f32> = state.bodies.iter().flat_map(|b| {
                let (p, q, v, w) = (b.position, b.rotation, b.linear_velocity, b.angular_velocity);
                [p.x, p.y, p.z, q.x, q.y, q.z, q.w, v.x, v.y, v.z, w.x, w.y, w.z]
            }).collect();
            let targets = controller.joint_targets().to_vec();
            ticks.push(json!({
                "before": pose(&before), "bodies": bodies, "targets": targets, "after": pose(&character.pose()),
            }));
        }
    }
    Ok(ticks)
}
