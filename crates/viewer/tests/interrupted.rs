//! What happens to a failure when the world changes behind it, and to replays while the player does something else.

mod common;

use std::sync::Arc;

use common::harness::harness;
use common::{playground, simulation};
use egui_kittest::kittest::Queryable as _;
use policy_core::{CharacterPack, GamepadState, Heading};
use replay::{Playback, Recorder};
use viewer::app::{App, Failure, PanelLayout, ViewerCommand};
use viewer::assets;
use viewer::replays::{Replaying, Setting};
use viewer::sim::{SimConfig, Simulation};

fn failed(characters: usize) -> App {
    let pack = Arc::new(CharacterPack::from_bytes(assets::HUMANOID_PACK).unwrap());
    let sim = Simulation::new(pack, SimConfig { characters, history: true, ..SimConfig::default() }).unwrap();
    let mut app = App::new(sim, PanelLayout::default());
    app.failure = Some(Failure { what: "broken".into(), replay: None, characters: vec![15] });
    app
}

#[test]
fn a_failure_ends_with_the_world_that_it_happened_in() {
    let changes = [ViewerCommand::Characters(1), ViewerCommand::Reset, ViewerCommand::ResetAfterFailure];
    for change in changes {
        let mut app = failed(20);
        app.apply(change.clone());
        assert_eq!(app.failure, None, "{change:?}");
    }
    // An index that is gone stands nobody up.
    let mut app = failed(1);
    app.apply(ViewerCommand::RewindAfterFailure);
    assert_eq!(app.failure, None);
}

#[test]
fn no_tick_can_be_asked_for_behind_a_failure() {
    let mut app = failed(1);
    app.apply(ViewerCommand::Step);
    assert_eq!((app.clock.paused, app.clock.steps), (false, 0));
}

/// A replay of so many ticks at rest, of the world of `app`.
fn recorded(app: &App, ticks: usize) -> Recorder {
    let mut recorder = Recorder::new(Setting::of(&app.sim).header(&app.sim, 0)).unwrap();
    let mut sim = simulation();
    for _ in 0..ticks {
        let pad = replay::Pad::from_state(&GamepadState::default(), Heading::FORWARD);
        sim.tick(&pad.state(), pad.heading());
        recorder.push(&[pad], sim.totals().hash.value()).unwrap();
    }
    recorder
}

#[test]
fn the_end_of_a_replay_stops_the_clock_and_is_told_until_the_player_goes_on() {
    let mut app = App::new(simulation(), PanelLayout::default());
    app.replaying = Replaying::Playing(Box::new(Playback::new(recorded(&app, 3).replay())));
    app.clock.speed = 8.0;
    // Many ticks are due in the frame in which it ends; a slow machine drops some.
    (0..50).for_each(|_| app.advance(0.2));
    assert!(app.clock.paused && app.sim.ticks() == 3, "{} ticks", app.sim.ticks());
    assert_eq!(app.replay_line.ended, Some(Ok(())));
    let mut harness = harness(app);
    harness.run_steps(2);
    assert!(harness.query_by_label_contains("is over").is_some());
    harness.state_mut().apply(ViewerCommand::Pause(false));
    harness.state_mut().advance(0.01);
    assert_eq!(harness.state().replay_line.ended, None);
}

#[test]
fn what_a_replay_does_not_keep_is_refused_while_one_is_recorded() {
    let mut app = App::new(playground(1), PanelLayout::default());
    app.tick();
    app.replaying = Replaying::Recording(Box::new(recorded(&app, 0)));
    let (ticks, props) = (app.sim.ticks(), app.sim.shared().unwrap().pieces().len());
    let (from, along) = (glam::Vec3::Z, glam::Vec3::X);
    let settings = policy_core::contract::Settings { gravity: 0.5, ..app.sim.model().settings() };
    for command in [
        ViewerCommand::Reset,
        ViewerCommand::Throw { from, along },
        ViewerCommand::Spawn { from, along },
        ViewerCommand::Scrub(1),
        ViewerCommand::Characters(2),
        ViewerCommand::Settings(settings),
        ViewerCommand::Compare(true),
    ] {
        app.apply(command.clone());
        let said = app.toasts.take_text();
        assert!(said.is_some_and(|said| said.contains("recorded or played")), "{command:?}");
    }
    let unchanged = (app.sim.ticks(), app.sim.shared().unwrap().pieces().len());
    assert_eq!((unchanged, app.sim.characters().len()), ((ticks, props), 1));
    assert_ne!(app.sim.model().settings(), settings);
    app.apply(ViewerCommand::Pause(true));
    assert!(app.clock.paused && app.toasts.is_empty(), "time is the player's");
}
