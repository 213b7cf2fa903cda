//! Shoves that do nothing, and a world that diverges again and again: told once, and the player keeps its place.
//! 200 divergences by default; `PROVOKED=2000` says how many.

mod common;

use common::simulation;
use glam::{Vec2, Vec3};
use physics::PhysicsCharacter as _;
use physics_bridge::{MAX_DISTANCE_M, Settings};
use policy_core::{BodyId, Buttons, GamepadState, Heading};
use viewer::app::{App, PanelLayout, ViewerCommand};
use viewer::sim::{SHOVE_BUTTON, SimConfig, Simulation};

const REST: GamepadState = GamepadState {
    left_stick: [0.0; 2],
    right_stick: [0.0; 2],
    left_trigger: 0.0,
    right_trigger: 0.0,
    buttons: Buttons::NONE,
};

fn torso(sim: &Simulation) -> BodyId {
    sim.pack().skeleton().body_named("torso").unwrap()
}

/// The button up for a tick, then down for one. True when a shove acts after that.
fn tap(sim: &mut Simulation) -> bool {
    let mut pressed = REST;
    pressed.buttons.set(SHOVE_BUTTON, true);
    sim.tick(&REST, Heading::FORWARD);
    sim.tick(&pressed, Heading::FORWARD);
    sim.character(0).is_pushed(torso(sim))
}

/// Puts the player into its pose with some numbers changed.
fn pose(sim: &mut Simulation, change: impl FnOnce(&mut physics_bridge::Pose)) {
    let mut pose = sim.character(0).pose();
    change(&mut pose);
    sim.character_mut(0).set_pose(&pose.qpos, &pose.qvel).unwrap();
}

#[test]
fn a_shove_while_one_acts_does_nothing() {
    let ends_after = |taps: usize| {
        let mut sim = simulation();
        assert!(tap(&mut sim), "the first shove acts");
        for _ in 1..taps {
            tap(&mut sim);
        }
        let ticks = 2 * (taps - 1);
        ticks
            + (0..60)
                .take_while(|_| {
                    let acts = sim.character(0).is_pushed(torso(&sim));
                    sim.tick(&REST, Heading::FORWARD);
                    acts
                })
                .count()
    };
    let alone = ends_after(1);
    assert!((4..=7).contains(&alone), "a fifth of a second, {alone} ticks");
    assert_eq!(ends_after(3), alone, "taps while it acts do not prolong it");
}

#[test]
fn a_shove_on_a_body_that_is_down_does_nothing() {
    let mut sim = simulation();
    let limp = Settings { strength: 0.0, ..Settings::default() };
    sim.set_settings(limp).unwrap();
    let falls = (0..150).any(|_| {
        sim.tick(&REST, Heading::FORWARD);
        sim.player().is_down()
    });
    assert!(falls && !tap(&mut sim), "at {} m it is shoved", sim.player().state.root_height());
}

#[test]
fn a_shove_on_a_body_that_is_fast_does_nothing() {
    let mut sim = simulation();
    pose(&mut sim, |pose| (pose.qpos[2], pose.qvel[0]) = (1.5, 9.0));
    assert!(!tap(&mut sim), "{} m/s", sim.player().speed());
    let mut sim = simulation();
    pose(&mut sim, |pose| pose.qvel[0] = 2.0);
    assert!(tap(&mut sim), "{} m/s", sim.player().speed());
}

/// Makes the next tick diverge, in one of several ways. True when the player stays in place by it.
fn provoke(sim: &mut Simulation, kind: usize) -> bool {
    let bodies = sim.pack().skeleton().body_count();
    match kind % 6 {
        0 => pose(sim, |pose| pose.qvel[1] = 400.0),
        1 => pose(sim, |pose| (pose.qpos[2], pose.qvel[5]) = (4.0, 900.0)),
        2 => pose(sim, |pose| pose.qpos[2] = -20.0),
        3 => pose(sim, |pose| pose.qpos[0] = 3e4),
        4 => pose(sim, |pose| *pose.qvel.last_mut().unwrap() = 1e10),
        _ => {
            for body in (0..bodies).map(BodyId::new) {
                let out = Vec3::new(1.0, body.index() as f32 - 7.0, 1.0).normalize();
                sim.character_mut(0).impulse(body, out * 9e5).unwrap();
            }
        }
    }
    kind % 6 != 3
}

#[test]
fn a_world_that_diverges_goes_on_at_the_same_place() {
    let wanted: usize = std::env::var("PROVOKED").map_or(200, |count| count.parse().unwrap());
    let mut sim = simulation();
    let forward = GamepadState { left_stick: [0.0, 1.0], ..REST };
    for kind in 0..wanted {
        for _ in 0..3 {
            assert!(sim.tick(&forward, Heading::FORWARD).is_empty(), "told again after {kind}");
        }
        let place = sim.player().position();
        let stays = provoke(&mut sim, kind);
        let told = sim.tick(&forward, Heading::FORWARD);
        assert_eq!(told.iter().map(|d| d.character).collect::<Vec<_>>(), [0], "kind {}", kind % 6);
        assert!(sim.tick(&forward, Heading::FORWARD).len() <= 1);
        sim.stand_up(0);
        let now = sim.player().position();
        let expected = if stays { place } else { Vec2::ZERO };
        assert!(now.distance(expected) < 0.5, "kind {}: {now}, was at {place}", kind % 6);
    }
    println!("{wanted} divergences in the demo's world");
}

#[test]
fn at_the_end_of_the_world_it_starts_again_at_the_beginning() {
    let mut sim = simulation();
    pose(&mut sim, |pose| pose.qpos[0] = f64::from(MAX_DISTANCE_M) - 1.0);
    sim.tick(&REST, Heading::FORWARD);
    sim.stand_up(0);
    assert!(sim.player().position().length() < 0.5, "{}", sim.player().position());
    assert!((0..30).all(|_| sim.tick(&REST, Heading::FORWARD).is_empty()));
}

/// Twenty characters, so that only the player keeps a history; three of them diverge in one tick.
#[test]
fn all_that_diverge_in_a_tick_are_told_at_once_and_none_is_left_behind() {
    let pack = std::sync::Arc::clone(simulation().pack());
    let sim =
        Simulation::new(pack, SimConfig { history: true, characters: 20, ..SimConfig::default() }).unwrap();
    let mut app = App::new(sim, PanelLayout::default());
    app.advance(0.2);
    for index in [2, 7, 19] {
        let mut pose = app.sim.character(index).pose();
        pose.qvel[0] = 300.0;
        app.sim.character_mut(index).set_pose(&pose.qpos, &pose.qvel).unwrap();
    }
    app.advance(0.1);
    let failure = app.failure.clone().unwrap();
    assert_eq!(failure.characters, [2, 7, 19]);
    assert!(failure.what.contains("character 2:") && failure.what.contains("2 more"), "{}", failure.what);
    app.apply(ViewerCommand::RewindAfterFailure);
    for _ in 0..20 {
        app.advance(0.05);
        assert_eq!(app.failure, None);
    }
    for index in [3, 4] {
        let mut pose = app.sim.character(index).pose();
        pose.qvel[0] = 300.0;
        app.sim.character_mut(index).set_pose(&pose.qpos, &pose.qvel).unwrap();
    }
    app.advance(0.1);
    let what = app.failure.unwrap().what;
    assert!(what.ends_with("(and 1 more character)"), "{what}");
}
