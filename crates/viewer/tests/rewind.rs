//! Going back in time: physics and controller together, so that what follows is what was never interrupted.

mod common;

use std::sync::Arc;

use common::{pack_with_skills, simulation, simulation_of};
use physics::PhysicsCharacter as _;
use physics_bridge::Pose;
use policy_core::{Button, GamepadState, Heading, TickReport};
use viewer::sim::{SHOVE_BUTTON, Simulation};

/// Ticks of a run: fewer than are kept.
const TICKS: usize = 280;

/// The pad at a tick: walks, lets blends move and rest, rolls, hops, is shoved over.
fn pad(tick: usize) -> GamepadState {
    let mut pad = GamepadState { left_stick: [0.0, 1.0], ..GamepadState::default() };
    pad.right_trigger = if (60..90).contains(&tick) { (tick - 60) as f32 / 30.0 } else { 0.0 };
    pad.buttons.set(Button::East, (100..104).contains(&tick) || (240..243).contains(&tick));
    pad.buttons.set(SHOVE_BUTTON, (150..156).contains(&tick));
    pad
}

/// What a tick came to: all that was seen of it.
type Tick = (Pose, TickReport);

fn tick(sim: &mut Simulation, number: usize, before: &mut dyn FnMut(&mut Simulation, usize)) -> Tick {
    before(sim, number);
    assert!(sim.tick(&pad(number), Heading::FORWARD).is_empty());
    (sim.character(0).pose(), *sim.player().report())
}

/// Runs once, then goes back by each of `ages` and runs on to the same end.
fn repeats(mut sim: Simulation, ages: &[usize], mut before: impl FnMut(&mut Simulation, usize)) -> Vec<Tick> {
    let ticks: Vec<Tick> = (0..TICKS).map(|number| tick(&mut sim, number, &mut before)).collect();
    for &age in ages {
        sim.rewind_to(age);
        assert_eq!(sim.character(0).pose(), ticks[TICKS - 1 - age].0);
        assert_eq!(*sim.player().report(), ticks[TICKS - 1 - age].1, "{age} ticks back");
        for (number, expected) in ticks.iter().enumerate().skip(TICKS - age) {
            let now = tick(&mut sim, number, &mut before);
            assert!(now == *expected, "{age} ticks back: tick {number} differs");
        }
    }
    ticks
}

#[test]
fn what_follows_is_bit_for_bit_what_was() {
    // Among them the middle of a roll, of a fall, of a get-up, of a moving blend, and a held button.
    let ticks =
        repeats(simulation(), &[1, 12, 37, 38, 60, 100, 124, 126, 170, 200, 205, 250, 279], |_, _| {});
    assert_ne!(ticks[TICKS - 1].0, ticks[0].0);
}

#[test]
fn a_skill_that_runs_or_waits_goes_on_from_its_middle() {
    let pack = pack_with_skills(0.9);
    let hop = pack.skill_named("hop");
    let sim = simulation_of(Arc::new(pack));
    let ages: Vec<usize> = (150..250).step_by(7).collect();
    let ticks = repeats(sim, &ages, |sim, number| {
        if number == 50 {
            sim.overrides.skill = hop;
        }
    });
    let runs = |from: usize| {
        ages.iter().any(|age| ticks[TICKS - 1 - age].1.skill.is_some_and(|s| s.seconds > from as f32 * 0.1))
    };
    assert!(runs(1), "some of the moments are in the middle of a skill");
}

#[test]
fn a_second_rewind_counts_from_the_new_present() {
    let mut sim = simulation();
    for number in 0..90 {
        tick(&mut sim, number, &mut |_, _| {});
    }
    sim.rewind_to(40);
    let there = sim.character(0).pose();
    for number in 50..60 {
        tick(&mut sim, number, &mut |_, _| {});
    }
    assert_eq!(sim.history(), (60, 0));
    sim.rewind_to(10);
    assert_eq!(sim.character(0).pose(), there);
}
