//! What is heard of a world: nothing while it rests, steps of one that walks, impacts by how hard they are.

mod common;

use common::{FORWARD, playground, simulation};
use glam::Vec3;
use physics_bridge::Motion;
use policy_core::{GamepadState, Heading};
use viewer::app::{App, PanelLayout};
use viewer::sim::{LooseKind, Simulation};
use viewer::sound::{Ear, Listener, Sound, Timbre};

const LISTENER: Listener = Listener { at: Vec3::new(0.0, 0.0, 1.0), right: Vec3::NEG_Y };

/// Runs a world under a pad and hears it; the sounds with the ticks that brought them.
fn hear(sim: &mut Simulation, ear: &mut Ear, pad: &GamepadState, ticks: usize) -> Vec<(usize, Sound)> {
    let mut heard = Vec::new();
    for tick in 0..ticks {
        sim.tick(pad, Heading::FORWARD);
        let listener = Listener { at: sim.player().state.root().position, ..LISTENER };
        ear.hear(sim, listener);
        heard.extend(ear.take().map(|sound| (tick, sound)));
    }
    heard
}

fn of(heard: &[(usize, Sound)], timbre: Timbre) -> Vec<(usize, Sound)> {
    heard.iter().copied().filter(|(_, sound)| sound.timbre == timbre).collect()
}

#[test]
fn who_stands_is_silent_and_who_walks_is_heard_step_by_step() {
    for mut sim in [playground(1), simulation()] {
        let mut ear = Ear::default();
        hear(&mut sim, &mut ear, &GamepadState::default(), 60);
        let still = hear(&mut sim, &mut ear, &GamepadState::default(), 60);
        let driven = |sound: &Sound| sound.timbre == Timbre::Air;
        assert!(still.iter().all(|(_, sound)| driven(sound)), "{still:?}");
        let walk = hear(&mut sim, &mut ear, &FORWARD, 90);
        let steps = of(&walk, Timbre::Step);
        // In three seconds, with the start.
        assert!((3..=14).contains(&steps.len()), "{steps:?}");
        assert!(steps.iter().all(|(_, step)| step.strength > 0.0 && step.strength <= 0.7), "{steps:?}");
    }
}

#[test]
fn a_fall_is_louder_than_steps() {
    let mut sim = playground(1);
    let mut ear = Ear::default();
    let steps = of(&hear(&mut sim, &mut ear, &FORWARD, 90), Timbre::Step);
    let shove = GamepadState {
        buttons: policy_core::Buttons::NONE.with(viewer::sim::SHOVE_BUTTON),
        ..GamepadState::default()
    };
    let mut fall = hear(&mut sim, &mut ear, &shove, 1);
    fall.extend(hear(&mut sim, &mut ear, &GamepadState::default(), 60));
    let thumps = of(&fall, Timbre::Body);
    let loudest =
        |sounds: &[(usize, Sound)]| sounds.iter().fold(0.0_f32, |most, (_, s)| most.max(s.strength));
    assert!(sim.player().is_down() || !thumps.is_empty(), "it was shoved to the ground");
    assert!(loudest(&thumps) > loudest(&steps), "{thumps:?}, {steps:?}");
}

/// The loudest sound of a timbre when a ball falls from a height, metres, well away from everything.
fn dropped(kind: LooseKind, height: f32, timbre: Timbre) -> f32 {
    let mut sim = playground(1);
    let mut ear = Ear::default();
    hear(&mut sim, &mut ear, &GamepadState::default(), 10);
    let at = Vec3::new(-2.0, -2.0, height);
    sim.shared_mut().unwrap().add_loose(kind, Motion::at(at)).unwrap();
    let heard = hear(&mut sim, &mut ear, &GamepadState::default(), 60);
    of(&heard, timbre).iter().fold(0.0, |most, (_, sound)| most.max(sound.strength))
}

#[test]
fn what_falls_farther_is_louder_and_sounds_of_what_it_is() {
    let [low, high] = [0.4, 2.5].map(|height| dropped(LooseKind::Ball, height, Timbre::Rubber));
    assert!(low > 0.05 && high > 1.3 * low, "{low}, {high}");
    assert!(dropped(LooseKind::Crate, 1.2, Timbre::Wood) > 0.1);
    assert!(dropped(LooseKind::Barrel, 1.2, Timbre::Steel) > 0.1);
    assert_eq!(dropped(LooseKind::Crate, 1.2, Timbre::Steel), 0.0);
}

#[test]
fn a_throw_is_heard_and_what_is_far_away_is_faint() {
    let strength_at = |far: f32| {
        let mut sim = playground(1);
        let mut ear = Ear::default();
        hear(&mut sim, &mut ear, &GamepadState::default(), 5);
        let thrown = Motion::at(Vec3::new(-2.0, -2.0, 2.0)).moving(Vec3::X * 9.0);
        sim.shared_mut().unwrap().add_loose(LooseKind::Ball, thrown).unwrap();
        sim.tick(&GamepadState::default(), Heading::FORWARD);
        ear.hear(&sim, Listener { at: Vec3::new(-2.0, -2.0 - far, 2.0), ..LISTENER });
        let heard: Vec<Sound> = ear.take().collect();
        heard.iter().find(|sound| sound.timbre == Timbre::Air).map_or(0.0, |sound| sound.strength)
    };
    assert!(strength_at(1.0) > 0.1);
    assert!(strength_at(20.0) < 0.5 * strength_at(1.0));
    assert_eq!(strength_at(60.0), 0.0);
}

#[test]
fn a_checkpoint_rings_bells() {
    let mut app = App::new(playground(1), PanelLayout::default());
    app.pad.state = FORWARD;
    let mut bells = 0;
    for _ in 0..150 {
        app.tick();
        bells += app.ear.take().filter(|sound| sound.timbre == Timbre::Bell).count();
    }
    assert!(app.sim.shared().unwrap().race().next() > 0, "it has passed the first checkpoint");
    assert_eq!(bells, 2, "the start is two bells");
}
