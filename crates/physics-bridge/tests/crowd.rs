//! A crowd does what its characters would do alone, on any number of threads.

mod common;

use std::num::NonZeroUsize;

use common::{hash, humanoid, wriggle_into};
use physics_bridge::{Cause, Character, Crowd};
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
