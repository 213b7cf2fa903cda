//! A crowd does what its characters would do alone, on any number of threads.

mod common;

use std::num::NonZeroUsize;

use common::{hash, humanoid, wriggle_into};
use glam::Vec3;
use physics_bridge::{Cause, Character, Crowd, Motion, Prop, World, Worlds};
use policy_core::{CharacterState, Heading, JointTargets};

const COUNT: usize = 11;

fn characters() -> Vec<Character> {
    let model = humanoid();
    let place = |index: usize| {
        let mut character = Character::new(&model);
        character
            .stand_at(index as f32, 0.5, Heading::from_angle(0.3 * index as f32), 0.1 * index as f32)
            .unwrap();
        character
    };
    (0..COUNT).map(place).collect()
}

fn crowd(threads: usize) -> Crowd {
    Crowd::new(characters(), NonZeroUsize::new(threads)).unwrap()
}

/// A policy that depends on everything it is given.
fn policy(index: usize, tick: u64, state: &CharacterState, targets: &mut JointTargets) {
    wriggle_into(tick + index as u64, targets);
    targets[3] += 0.1 * state.bodies[2].position.x + 0.01 * state.joint_velocities[5];
}

fn hashes(crowd: &Crowd) -> Vec<u64> {
    crowd.characters().map(hash).collect()
}

#[test]
fn threads_change_no_bit() {
    let run = |threads| {
        let mut crowd = crowd(threads);
        assert_eq!(crowd.threads(), threads);
        for tick in 0..40 {
            assert_eq!(crowd.tick(|index, state, targets| policy(index, tick, state, targets)), 0);
        }
        hashes(&crowd)
    };
    let one = run(1);
    assert_eq!(one, run(2));
    assert_eq!(one, run(5));
    let mut alone = characters();
    let skeleton = humanoid().skeleton().clone();
    let mut state = CharacterState::new(&skeleton);
    for (index, character) in alone.iter_mut().enumerate() {
        for tick in 0..40 {
            let mut targets = JointTargets::new(&skeleton);
            character.sense_into(&mut state);
            policy(index, tick, &state, &mut targets);
            character.actuate(&targets);
            character.step().unwrap();
        }
    }
    assert_eq!(one, alone.iter().map(hash).collect::<Vec<_>>());
}

#[test]
fn the_three_ways_to_tick_agree() {
    let (mut first, mut second, mut third) = (crowd(2), crowd(2), crowd(2));
    let skeleton = humanoid().skeleton().clone();
    let mut ticks = vec![0; COUNT];
    let (mut states, mut all) =
        (vec![CharacterState::new(&skeleton); COUNT], vec![JointTargets::new(&skeleton); COUNT]);
    for tick in 0..20 {
        first.tick(|index, state, targets| policy(index, tick, state, targets));
        second.tick_with(&mut ticks, |index, tick, state, targets| {
            policy(index, *tick, state, targets);
            *tick += 1;
        });
        third.sense_into(&mut states);
        for (index, (state, targets)) in states.iter().zip(&mut all).enumerate() {
            policy(index, tick, state, targets);
        }
        third.step(&all);
    }
    assert_eq!(hashes(&first), hashes(&second));
    assert_eq!(hashes(&first), hashes(&third));
}

#[test]
fn one_that_diverges_leaves_the_others_alone() {
    let (mut crowd, mut other) = (crowd(2), crowd(2));
    let diverged = crowd.tick(|index, _, targets| {
        if index == 4 {
            targets[0] = f32::NAN;
        }
    });
    assert_eq!(diverged, 1);
    let failures: Vec<_> = crowd.diverged().map(|(index, error)| (index, error.cause)).collect();
    assert_eq!(failures, [(4, Cause::BadControl)]);
    assert_eq!(other.tick(|_, _, _| ()), 0);
    for (index, (a, b)) in hashes(&crowd).into_iter().zip(hashes(&other)).enumerate() {
        assert_eq!(a == b, index != 4, "character {index}");
    }
    assert_eq!(crowd.tick(|_, _, _| ()), 0);
    assert_eq!(crowd.diverged().count(), 0);
}

#[test]
fn an_empty_crowd_ticks() {
    let mut crowd: Crowd = Crowd::new(Vec::new(), None).unwrap();
    assert!(crowd.is_empty());
    assert_eq!(crowd.tick(|_, _, _| ()), 0);
}

#[test]
fn threads_change_no_bit_of_worlds() {
    let model = humanoid();
    let run = |threads| {
        let world = |index: usize| {
            let mut world = World::new(&model).unwrap();
            world
                .edit(|edit| {
                    for x in 0..2 {
                        let x = 0.4 * x as f32;
                        edit.add_character(&model, x, 0.1 * index as f32, Heading::FORWARD, 0.5)?;
                    }
                    edit.add_prop(Prop::cube(0.3, 3.0), Motion::at(Vec3::new(0.2, 0.0, 2.0)))
                })
                .unwrap();
            world
        };
        let mut worlds = Worlds::new((0..5).map(world).collect(), NonZeroUsize::new(threads)).unwrap();
        let mut ticks = [0; 5];
        for _ in 0..20 {
            let diverged = worlds.tick_with(&mut ticks, |index, tick, world| {
                let mut targets = JointTargets::new(model.skeleton());
                wriggle_into(*tick + index as u64, &mut targets);
                *tick += 1;
                let characters: Vec<_> = world.characters().collect();
                characters.into_iter().for_each(|who| world.actuate(who, &targets).unwrap());
                world.step()
            });
            assert_eq!(diverged, 0);
        }
        worlds.worlds().iter().map(|world| world.save().hash()).collect::<Vec<_>>()
    };
    let one = run(1);
    assert_eq!(one, run(3));
    assert!(one[0] != one[1], "each is its own");
}
