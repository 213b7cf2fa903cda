//! The physics, the observation and the discriminator features against the golden walk.

use std::sync::Arc;

use integration_tests::HUMANOID_MJCF;
use integration_tests::golden::{GoldenTick, golden_walk, largest_difference};
use mujoco_rs::wrappers::mj_data::MjData;
use mujoco_rs::wrappers::mj_model::MjModel;
use physics_bridge::{Character, Model};
use policy_core::training::{ActionScaling, discriminator_frame_into};
use policy_core::{CharacterState, JointTargets, Skeleton, observe_into};

const TOLERANCE: f32 = 1e-5;

/// The character with the solver of the recording, which stopped after four iterations. The one that ships converges.
fn recorded_mjcf() -> String {
    let (now, then) = (r#" iterations="20" ls_iterations="20""#, r#" iterations="4" ls_iterations="8""#);
    assert!(HUMANOID_MJCF.contains(now), "expected{now} in the model");
    HUMANOID_MJCF.replace(now, then)
}

fn pose(character: &mut Character, tick: &GoldenTick) {
    character.set_pose(&tick.qpos, &tick.qvel).unwrap();
}

fn targets(tick: &GoldenTick) -> JointTargets {
    tick.ctrl.iter().map(|&target| target as f32).collect::<Vec<_>>().into()
}

/// The largest difference between two lists of the same length.
fn furthest(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, |x, y| if y > x || y.is_nan() { y } else { x })
}

#[test]
fn the_recording_is_in_our_order() {
    let (golden, model) = (golden_walk(), Model::from_mjcf(HUMANOID_MJCF).unwrap());
    for skeleton in [&Skeleton::humanoid(), &**model.skeleton()] {
        let joints: Vec<_> = skeleton.joints().iter().map(|joint| joint.name.as_str()).collect();
        let bodies: Vec<_> = skeleton.bodies().iter().map(|body| body.name.as_str()).collect();
        assert_eq!(golden.actuators, joints);
        assert_eq!(golden.joints_in_qpos_order, joints);
        assert_eq!(golden.bodies, bodies);
    }
    assert_eq!(golden.ticks.len(), 60);
}

#[test]
fn every_tick_is_sensed_as_recorded() {
    let model = Model::from_mjcf(HUMANOID_MJCF).unwrap();
    let mut character = Character::new(&model);
    let skeleton = model.skeleton();
    let mut state = CharacterState::new(skeleton);
    let (mut observation, mut frame) =
        (vec![0.0; skeleton.observation_len()], vec![0.0; skeleton.frame_len()]);
    for (index, tick) in golden_walk().ticks.iter().enumerate() {
        pose(&mut character, tick);
        character.sense_into(&mut state);
        observe_into(skeleton, &state, &mut observation);
        discriminator_frame_into(skeleton, &state, &mut frame);
        let (at, difference) = largest_difference(&observation, &tick.observation);
        assert!(difference <= TOLERANCE, "tick {index}: observation[{at}] differs by {difference}");
        let (at, difference) = largest_difference(&frame, &tick.discriminator_frame);
        assert!(difference <= TOLERANCE, "tick {index}: discriminator_frame[{at}] differs by {difference}");
    }
}

#[test]
fn every_action_becomes_the_recorded_targets() {
    let model = Model::from_mjcf(HUMANOID_MJCF).unwrap();
    let scaling = ActionScaling::from_skeleton(model.skeleton());
    let mut found = JointTargets::new(model.skeleton());
    for (index, tick) in golden_walk().ticks.iter().enumerate() {
        scaling.targets_into(&tick.action, &mut found);
        let (at, difference) = largest_difference(&found, &targets(tick));
        assert!(difference <= TOLERANCE, "tick {index}: ctrl[{at}] differs by {difference}");
    }
}

/// MuJoCo itself follows the recording when it gets the recorded joint targets in double precision. So the character
/// in `assets/` is the one that was recorded, except for its solver. On the machine of the recording not a bit differs;
/// the tolerance is for the sines of other systems' libraries.
#[test]
fn bare_mujoco_repeats_the_recording() {
    let model = Arc::new(MjModel::from_xml_string(&recorded_mjcf()).unwrap());
    let golden = golden_walk();
    let mut data = MjData::new(Arc::clone(&model));
    data.qpos_mut().copy_from_slice(&golden.ticks[0].qpos);
    data.qvel_mut().copy_from_slice(&golden.ticks[0].qvel);
    for (index, tick) in golden.ticks.iter().enumerate() {
        let (qpos, qvel) = (furthest(data.qpos(), &tick.qpos), furthest(data.qvel(), &tick.qvel));
        assert!(qpos < 1e-9 && qvel < 1e-7, "tick {index}: qpos differs by {qpos}, qvel by {qvel}");
        data.ctrl_mut().copy_from_slice(&tick.ctrl);
        for _ in 0..4 {
            data.step();
        }
    }
}

/// A character gets its joint targets in single precision. It leaves the recording by their rounding, which contacts
/// magnify.
#[test]
fn the_recorded_targets_reproduce_the_recorded_motion() {
    let model = Model::from_mjcf(&recorded_mjcf()).unwrap();
    let golden = golden_walk();
    let mut character = Character::new(&model);
    pose(&mut character, &golden.ticks[0]);
    for (index, tick) in golden.ticks.iter().enumerate() {
        let difference = furthest(&character.pose().qpos, &tick.qpos);
        assert!(difference <= TOLERANCE.into(), "tick {index}: qpos differs by {difference}");
        character.actuate(&targets(tick));
        character.step().unwrap();
    }
}
