//! Control ticks: one call for a character or a crowd does what its parts do.

mod common;

use std::num::NonZeroUsize;
use std::sync::Arc;

use common::{HUMANOID, QUADRUPED, hash, made_up_pack, quadruped};
use glam::Vec2;
use physics_bridge::{Character, Crowd, Model, ModelError};
use policy_core::{
    BlendMode, CharacterPack, CharacterState, Command, Controller, ControllerConfig, Goal, Heading, Skeleton,
    StateFault,
};

const DT_SECS: f32 = 1.0 / 30.0;

/// A pack with its body, and the body.
fn four_legs() -> (Arc<CharacterPack>, Model) {
    let model = quadruped();
    let pack = made_up_pack(model.skeleton(), Some(QUADRUPED), model.actuation());
    let pack = CharacterPack::from_bytes(&pack.to_bytes()).unwrap();
    let model = Model::for_pack(&pack).unwrap();
    (Arc::new(pack), model)
}

/// What the character of an index is asked: every other one moves along the path, to its own point.
fn command(pack: &CharacterPack, index: usize, tick: usize) -> Command {
    let path = pack.graph().path_named("speed").unwrap();
    let coordinate = if index.is_multiple_of(2) { 0.02 * tick as f32 } else { 0.4 };
    Command {
        target: Some(Vec2::new(5.0, index as f32)),
        goal: Goal::Path { path, coordinate },
        ..Command::default()
    }
}

fn crowd(model: &Model, count: usize, threads: usize) -> Crowd {
    let place = |index: usize| {
        let mut character = Character::new(model);
        character.stand_at(index as f32, 0.0, Heading::from_angle(0.2 * index as f32), 0.0).unwrap();
        character
    };
    Crowd::new((0..count).map(place).collect(), NonZeroUsize::new(threads)).unwrap()
}

#[test]
fn a_pack_with_its_mjcf_makes_its_model() {
    let (pack, model) = four_legs();
    assert_eq!(model.skeleton(), pack.skeleton());
    assert_eq!(Some(&model.actuation()), pack.actuation());
    assert_eq!(model.control_hz(), pack.control_hz());
    let bare = made_up_pack(&Skeleton::humanoid(), None, common::humanoid().actuation());
    let error = Model::for_pack(&bare).unwrap_err();
    assert!(matches!(error, ModelError::NoMjcf) && error.to_string().contains("pass the MJCF"), "{error}");
    let model = Model::from_mjcf_with_skeleton(HUMANOID, bare.skeleton().clone()).unwrap();
    assert_eq!(model.skeleton(), bare.skeleton());
}

#[test]
fn a_control_tick_is_its_parts() {
    let (pack, model) = four_legs();
    let (mut whole, mut parts) = (Character::new(&model), Character::new(&model));
    let (mut first, mut second) = (Controller::new(pack.clone()), Controller::new(pack.clone()));
    let mut state = CharacterState::new(model.skeleton());
    for tick in 0..60 {
        let command = command(&pack, 0, tick);
        whole.control_tick(&mut first, &command, DT_SECS).unwrap();
        parts.sense_into(&mut state);
        assert_eq!(&state, whole.sensed());
        parts.actuate(second.tick(&state, &command, DT_SECS));
        parts.step().unwrap();
        assert_eq!(hash(&whole), hash(&parts));
        assert_eq!(first.report(), second.report());
    }
    assert!(first.report().position.as_node().is_none(), "it is between two nodes");
}

#[test]
fn a_controller_of_another_skeleton_is_a_fault() {
    let (pack, _) = four_legs();
    let mut character = Character::new(&common::humanoid());
    let mut controller = Controller::new(pack);
    character.control_tick(&mut controller, &Command::default(), DT_SECS).unwrap();
    assert_eq!(controller.report().fault, Some(StateFault::WrongSize));
}

/// Runs a crowd for a while; returns the hash of each character.
fn run(count: usize, threads: usize) -> Vec<u64> {
    let (pack, model) = four_legs();
    let mut crowd = crowd(&model, count, threads);
    let mut controllers = vec![Controller::new(pack.clone()); count];
    for tick in 0..30 {
        let commands: Vec<_> = (0..count).map(|index| command(&pack, index, tick)).collect();
        assert_eq!(crowd.control_tick(&mut controllers, &commands, DT_SECS), 0);
    }
    assert!(!crowd.control_time().is_zero());
    crowd.characters().map(hash).collect()
}

#[test]
fn threads_change_no_bit_of_a_batch() {
    let one = run(53, 1);
    assert_eq!(one, run(53, 2));
    assert_eq!(one, run(53, 7));
    assert_eq!(one[..30], run(30, 3), "neither do the characters behind it");
}

#[test]
fn a_small_crowd_does_what_its_characters_do_alone() {
    let (pack, model) = four_legs();
    let found = run(5, 2);
    for (index, found) in found.into_iter().enumerate() {
        let mut character = crowd(&model, 5, 1).character(index).save();
        let mut alone = Character::new(&model);
        alone.restore(&character).unwrap();
        let mut controller = Controller::new(pack.clone());
        for tick in 0..30 {
            alone.control_tick(&mut controller, &command(&pack, index, tick), DT_SECS).unwrap();
        }
        alone.save_into(&mut character);
        assert_eq!(character.hash(), found);
    }
}

/// The batch agrees with one by one to rounding, which a few ticks do not magnify much.
#[test]
fn a_batch_agrees_with_one_by_one() {
    let (pack, model) = four_legs();
    const COUNT: usize = 31;
    let (mut batched, mut single) = (crowd(&model, COUNT, 2), crowd(&model, COUNT, 1));
    let mut controllers = vec![Controller::new(pack.clone()); COUNT];
    // Some that the batch can't take: another mode, another pack.
    let actions = ControllerConfig { blend_mode: BlendMode::Actions, ..ControllerConfig::default() };
    controllers[3] = Controller::with_config(pack.clone(), actions);
    controllers[7] = Controller::new(four_legs().0);
    let mut others = controllers.clone();
    for tick in 0..8 {
        let commands: Vec<_> = (0..COUNT).map(|index| command(&pack, index, tick)).collect();
        assert_eq!(batched.control_tick(&mut controllers, &commands, DT_SECS), 0);
        let characters = single.characters_mut().zip(&mut others).zip(&commands);
        characters
            .for_each(|((c, controller), command)| c.control_tick(controller, command, DT_SECS).unwrap());
        for (index, (a, b)) in controllers.iter().zip(&others).enumerate() {
            let furthest = a.joint_targets().iter().zip(&**b.joint_targets()).map(|(a, b)| (a - b).abs());
            let furthest = furthest.fold(0.0, f32::max);
            assert!(furthest < 1e-3, "tick {tick}, character {index}: {furthest} rad");
            assert_eq!(a.report().position, b.report().position);
        }
    }
}

#[test]
fn controllers_may_be_part_of_something_larger() {
    struct Actor {
        controller: Controller,
        command: Command,
    }
    let (pack, model) = four_legs();
    let mut crowd = crowd(&model, 30, 2);
    let mut actors: Vec<Actor> = (0..30)
        .map(|_| Actor { controller: Controller::new(pack.clone()), command: Command::default() })
        .collect();
    for tick in 0..30 {
        for (index, actor) in actors.iter_mut().enumerate() {
            actor.command = command(&pack, index, tick);
        }
        crowd.control_tick_with(&mut actors, DT_SECS, |_, actor| (&mut actor.controller, actor.command));
    }
    assert_eq!(crowd.characters().map(hash).collect::<Vec<_>>(), run(30, 2));
}

#[test]
fn one_that_diverges_in_a_batch_leaves_the_others_alone() {
    let (pack, model) = four_legs();
    let mut crowd = crowd(&model, 8, 2);
    let mut pose = crowd.character(2).pose();
    pose.qvel[0] = 80.0;
    crowd.character_mut(2).set_pose(&pose.qpos, &pose.qvel).unwrap();
    let mut controllers = vec![Controller::new(pack); 8];
    assert_eq!(crowd.control_tick(&mut controllers, &[Command::default(); 8], DT_SECS), 1);
    assert_eq!(crowd.diverged().map(|(index, _)| index).collect::<Vec<_>>(), [2]);
    assert!(crowd.characters().enumerate().all(|(index, c)| c.tick() == u64::from(index != 2)));
}
