//! The controller in the physics: the recorded Walk policy, closed loop, against its recording.

use std::hash::Hasher;
use std::sync::Arc;

use glam::Vec2;
use integration_tests::HUMANOID_MJCF;
use integration_tests::golden::{golden_walk, largest_difference};
use physics_bridge::{Character, Model, Terrain};
use policy_core::{
    Body, CharacterPack, CharacterState, Command, Controller, ControllerConfig, Goal, GraphPosition,
};

const TOLERANCE: f32 = 1e-5;
const DT: f32 = 1.0 / 30.0;

/// The policies the recording was made with.
fn reference_pack() -> Arc<CharacterPack> {
    Arc::new(CharacterPack::from_bytes(include_bytes!("golden/reference.pack.safetensors")).unwrap())
}

fn walking() -> (Character, Controller) {
    let pack = reference_pack();
    let start = pack.graph().node_named("walk").unwrap();
    let controller = Controller::with_config(pack, ControllerConfig { start, ..ControllerConfig::default() });
    let mut character = Character::new(&Model::from_mjcf(HUMANOID_MJCF).unwrap());
    let first = &golden_walk().ticks[0];
    let (qpos, qvel) = (first.qpos.as_slice().try_into().unwrap(), first.qvel.as_slice().try_into().unwrap());
    character.set_pose(qpos, qvel).unwrap();
    (character, controller)
}

#[test]
fn every_recorded_state_gives_the_recorded_input_action_and_targets() {
    let golden = golden_walk();
    let (mut character, mut controller) = walking();
    let command = Command { target: Some(Vec2::from_array(golden.target_world)), ..Command::default() };
    let mut state = CharacterState::default();
    for (index, tick) in golden.ticks.iter().enumerate() {
        let (qpos, qvel) =
            (tick.qpos.as_slice().try_into().unwrap(), tick.qvel.as_slice().try_into().unwrap());
        character.set_pose(qpos, qvel).unwrap();
        character.sense_into(&mut state);
        let targets = controller.tick(&state, &command, DT).0;
        let ctrl: Vec<f32> = tick.ctrl.iter().map(|&c| c as f32).collect();
        let scaling = controller.pack().action();
        let action: Vec<f32> =
            (0..28).map(|j| (targets[j] - scaling.centre()[j]) / scaling.gain()[j]).collect();
        let compared = [
            ("policy input", controller.policy_input().as_slice(), tick.policy_input.as_slice()),
            ("action", &action, &tick.action),
            ("ctrl", &targets, &ctrl),
        ];
        for (what, found, expected) in compared {
            let (at, difference) = largest_difference(found, expected);
            assert!(difference <= TOLERANCE, "tick {index}: {what}[{at}] differs by {difference}");
        }
    }
}

#[test]
fn walk_stays_up_for_ten_seconds_and_ends_where_the_recording_ends() {
    let golden = golden_walk();
    let (mut character, mut controller) = walking();
    let command = Command { target: Some(Vec2::from_array(golden.target_world)), ..Command::default() };
    let mut state = CharacterState::default();
    for tick in 0..300 {
        character.sense_into(&mut state);
        character.actuate(controller.tick(&state, &command, DT));
        character.step().unwrap();
        let height = state.body(Body::Pelvis).position.z;
        assert!(height > 0.7 && !controller.report().fallen, "pelvis at {height} m in tick {tick}");
    }
    let end = character.pose().qpos;
    let expected = &golden.final_qpos_after_300_ticks;
    let apart = (end[0] - expected[0]).hypot(end[1] - expected[1]);
    assert!(
        apart < 0.5,
        "ends {apart} m from the recording, which walked {} m",
        expected[0].hypot(expected[1])
    );
}

/// A trigger that moves, a target that turns, uneven ground: the same bits in every run.
fn hash_of_a_run(terrain: Terrain) -> u64 {
    let pack = reference_pack();
    let model = Model::from_mjcf(HUMANOID_MJCF).unwrap().with_terrain(terrain).unwrap();
    let mut character = Character::new(&model);
    let mut controller = Controller::new(Arc::clone(&pack));
    controller.place_at(GraphPosition::node(1));
    let mut state = CharacterState::default();
    let mut hasher = std::hash::DefaultHasher::new();
    for tick in 0..150u16 {
        let seconds = f32::from(tick) * DT;
        let command = Command {
            target: Some(Vec2::new(4.0 - seconds, seconds)),
            goal: Goal::Path { path: 0, coordinate: 1.0 - 0.1 * seconds },
            ..Command::default()
        };
        character.sense_into(&mut state);
        character.actuate(controller.tick(&state, &command, DT));
        character.step().unwrap();
        character.pose().qpos.iter().for_each(|q| hasher.write_u64(q.to_bits()));
    }
    hasher.finish()
}

#[test]
fn two_runs_give_the_same_bits_and_other_ground_others() {
    let wavy = Terrain::Wavy { height_m: 0.04, wavelength_m: 3.0, seed: 3 };
    assert_eq!(hash_of_a_run(wavy), hash_of_a_run(wavy));
    assert_ne!(hash_of_a_run(wavy), hash_of_a_run(Terrain::Flat));
}
