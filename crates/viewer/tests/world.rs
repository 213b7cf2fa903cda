//! The world of the demo: ghosts, going back, falls, what is refused; and recordings.

mod common;

use common::{FORWARD, simulation};
use image::{Rgba, RgbaImage};
use physics::PhysicsCharacter as _;
use physics_bridge::Settings;
use policy_core::{BlendMode, Buttons, GamepadState, Heading};
use viewer::app::{App, PanelLayout, ViewerCommand};
use viewer::recorder::{Kind, Recorder};
use viewer::sim::{
    Engine, GhostKind, GroundKind, LEAST_FRICTION, LIE_SECS, SHOVE_BUTTON, SimConfig, SimError, Simulation,
};

fn torso(sim: &Simulation) -> policy_core::BodyId {
    sim.pack().skeleton().body_named("torso").unwrap()
}

fn run(sim: &mut Simulation, ticks: usize) {
    for _ in 0..ticks {
        assert!(sim.tick(&FORWARD, Heading::FORWARD).is_empty());
    }
}

#[test]
fn a_ghost_under_the_same_mode_does_the_same_and_under_another_does_not() {
    let mut sim = simulation();
    run(&mut sim, 20);
    sim.start_ghost(GhostKind::Mode(BlendMode::Parameters)).unwrap();
    run(&mut sim, 40);
    assert_eq!(sim.ghost_poses(1.0), Some(sim.player().poses(1.0)));
    let mut sim = simulation();
    run(&mut sim, 5);
    sim.start_ghost(GhostKind::Mode(BlendMode::Switch)).unwrap();
    run(&mut sim, 40);
    assert_ne!(sim.ghost_poses(1.0), Some(sim.player().poses(1.0)));
}

/// A world like another, in Rapier.
fn in_rapier() -> Simulation {
    let mut sim = simulation();
    sim.rebuild(SimConfig { engine: Engine::Rapier, ..*sim.config() }).unwrap();
    sim
}

#[test]
fn a_ghost_in_the_other_engine_walks_along_and_ends() {
    for mut sim in [simulation(), in_rapier()] {
        let other = sim.engine().other();
        run(&mut sim, 20);
        sim.start_ghost(GhostKind::Engine(other)).unwrap();
        assert_eq!(sim.ghost().unwrap().kind(), GhostKind::Engine(other));
        let start = sim.ghost_poses(1.0).unwrap().positions[0];
        assert!((start - sim.player().poses(1.0).positions[0]).length() < 1e-4, "from the same state");
        run(&mut sim, 30);
        let (ghost, player) = (sim.ghost_poses(1.0).unwrap().positions[0], sim.player().position());
        assert!(ghost.truncate().distance(start.truncate()) > 0.3, "it walks in {}", other.title());
        assert!(ghost.truncate().distance(player) < 0.5, "beside the player");
        assert_ne!(ghost, sim.player().poses(1.0).positions[0], "other contacts, another way");
        sim.set_settings(Settings { gravity: 0.5, ..Settings::default() }).unwrap();
        run(&mut sim, 3);
        sim.stop_ghost();
        assert!(sim.ghost().is_none());
    }
}

#[test]
fn a_world_in_rapier_walks_on_hills_is_shoved_and_keeps_no_history() {
    let mut sim = in_rapier();
    sim.rebuild(SimConfig { characters: 2, ground: GroundKind::Wavy, ..*sim.config() }).unwrap();
    assert_eq!(sim.engine(), Engine::Rapier);
    run(&mut sim, 45);
    assert!(sim.player().position().length() > 0.3, "{}", sim.player().position());
    assert_eq!(sim.history(), (0, 0));
    let there = sim.character(0).pose();
    sim.rewind_to(10);
    assert_eq!(sim.character(0).pose(), there);
    let shove = GamepadState { buttons: Buttons::NONE.with(SHOVE_BUTTON), ..FORWARD };
    assert!(sim.tick(&shove, Heading::FORWARD).is_empty());
    let torso = sim.model().skeleton().body_named("torso").unwrap();
    assert!(sim.character(0).is_pushed(torso));
    sim.reset();
    assert!(sim.player().position().length() < 0.05 && !sim.character(0).is_pushed(torso));
}

#[test]
fn going_back_and_on_leads_to_the_same_place() {
    let mut sim = simulation();
    run(&mut sim, 90);
    let there = sim.character(0).pose();
    assert_eq!(sim.history(), (90, 0));
    // From a moment at which the blend rests, so that nothing but the physics matters.
    sim.rewind_to(10);
    assert_ne!(sim.character(0).pose(), there);
    run(&mut sim, 10);
    assert_eq!(sim.history(), (90, 0));
    assert_eq!(sim.character(0).pose(), there);
    // A second way back counts from the new present.
    sim.rewind_to(90);
    assert!(sim.player().position().length() < 0.05);
}

#[test]
fn who_falls_without_a_skill_to_rise_is_counted_and_stood_up() {
    let mut sim = simulation();
    let mut limp = sim.model().settings();
    limp.strength = 0.0;
    sim.set_settings(limp).unwrap();
    let ticks = ((LIE_SECS + 3.0) / sim.tick_secs()) as usize;
    run(&mut sim, ticks);
    assert!(sim.totals().falls >= 1, "{:?}", sim.totals());
    if sim.pack().recovery().is_none() {
        assert!(sim.totals().stood_up >= 1, "{:?}", sim.totals());
    }
    assert!(sim.totals().down_ticks > 30);
}

#[test]
fn a_shove_comes_once_however_long_its_button_is_held() {
    let mut held = FORWARD;
    held.buttons.set(SHOVE_BUTTON, true);
    let mut sim = simulation();
    run(&mut sim, 30);
    let torso = torso(&sim);
    let speed = |sim: &Simulation| sim.player().state.body(torso).linear_velocity.x;
    let before = speed(&sim);
    let pushed = (0..67).filter(|tick| {
        sim.tick(&held, Heading::FORWARD);
        assert!(*tick != 6 || speed(&sim) > before + 2.0, "{} after {before}", speed(&sim));
        sim.character(0).is_pushed(torso)
    });
    let ticks = pushed.count();
    assert!((1..=7).contains(&ticks), "one push of 0.2 s, {ticks} ticks");
}

#[test]
fn shoves_three_times_a_second_do_not_add_up() {
    let mut held = FORWARD;
    held.buttons.set(SHOVE_BUTTON, true);
    let mut sim = simulation();
    let torso = torso(&sim);
    let (mut shoves, mut was_pushed) = (0, false);
    let (mut fastest, mut lowest) = (0.0_f32, f32::INFINITY);
    for tick in 0..1800 {
        let before = sim.player().state.root().linear_velocity.length();
        let pad = if tick % 10 < 3 { &held } else { &FORWARD };
        assert!(sim.tick(pad, Heading::FORWARD).is_empty(), "it blew up in tick {tick}");
        let is_pushed = sim.character(0).is_pushed(torso);
        if is_pushed && !was_pushed {
            shoves += 1;
            assert!(before < 5.01, "a shove in tick {tick}, at {before} m/s");
        }
        was_pushed = is_pushed;
        let torso = sim.player().state.body(torso);
        fastest = fastest.max(torso.linear_velocity.length());
        lowest = lowest.min(torso.position.z);
    }
    assert!(shoves > 3, "{shoves}");
    assert!(fastest < 12.0 && lowest > -0.05, "{fastest} m/s, {lowest} m");
}

#[test]
fn without_friction_it_slides_and_can_be_started_again() {
    let mut sim = simulation();
    let ice = Settings { friction: 0.0, ..sim.model().settings() };
    sim.set_settings(ice).unwrap();
    run(&mut sim, 150);
    sim.reset();
    run(&mut sim, 60);
    sim.rewind_to(30);
    run(&mut sim, 60);
}

#[test]
fn on_ice_the_demo_goes_on_and_starts_again_after_a_failure() {
    let mut app = App::new(simulation(), PanelLayout::default());
    let settings = Settings { friction: 0.0, ..app.sim.model().settings() };
    app.apply(ViewerCommand::Settings(settings));
    assert_eq!(app.sim.model().settings().friction, LEAST_FRICTION);
    app.pad.state = FORWARD;
    app.pad.state.right_trigger = 1.0;
    for again in [ViewerCommand::ResetAfterFailure, ViewerCommand::RewindAfterFailure] {
        for tick in 0..300 {
            app.pad.state.buttons.set(SHOVE_BUTTON, tick % 90 == 60);
            let diverged = app.tick();
            assert!(diverged.is_empty(), "tick {tick}: {}", diverged[0].what);
        }
        let torso = torso(&app.sim);
        app.sim.character_mut(0).impulse(torso, glam::Vec3::Y * 9e5).unwrap();
        app.advance(0.1);
        assert!(app.failure.is_some());
        app.apply(again);
        for _ in 0..20 {
            app.advance(0.05);
            assert_eq!(app.failure, None);
        }
    }
}

#[test]
fn a_crouch_without_the_stick_is_sent_back_to_its_place() {
    let crouched = GamepadState { left_trigger: 0.5, left_stick: [0.0; 2], ..FORWARD };
    let mut sim = simulation();
    let put = |sim: &mut Simulation, x: f64| {
        let mut pose = sim.character(0).pose();
        pose.qpos[0] += x;
        pose.qvel.fill(0.0);
        sim.character_mut(0).set_pose(&pose.qpos, &pose.qvel).unwrap();
        (0..2).for_each(|_| drop(sim.tick(&crouched, Heading::FORWARD)));
    };
    (0..150).for_each(|_| drop(sim.tick(&crouched, Heading::FORWARD)));
    // At rest it has a place, if it had none before.
    put(&mut sim, 0.0);
    for away in [10.0, -20.0] {
        put(&mut sim, away);
        let here = sim.player().position();
        let back = (sim.player().command.target.unwrap() - here).normalize();
        assert!(back.x * (away as f32).signum() < -0.9, "from {here} along {back}");
    }
    // With the stick, or standing, there is no place to keep.
    sim.tick(&FORWARD, Heading::FORWARD);
    assert!(sim.player().command.target.unwrap().x > sim.player().position().x + 3.0);
    sim.tick(&GamepadState { left_trigger: 0.0, ..crouched }, Heading::FORWARD);
    assert_eq!(sim.player().command.target, None);
}

#[test]
fn what_is_out_of_range_changes_nothing() {
    let mut sim = simulation();
    let mut heavy = sim.model().settings();
    heavy.gravity = 1e9;
    assert!(matches!(sim.set_settings(heavy), Err(SimError::Model(_))));
    assert_eq!(sim.model().settings(), Settings::default());
    let config = SimConfig { characters: 0, ..*sim.config() };
    assert!(matches!(sim.rebuild(config), Err(SimError::Characters { found: 0 })));
    assert_eq!(sim.characters().len(), 1);
}

fn picture(number: u8) -> RgbaImage {
    RgbaImage::from_pixel(16, 8, Rgba([number * 40, 20, 200, 255]))
}

#[test]
fn a_film_without_ffmpeg_is_an_animation_of_all_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("film.apng");
    let mut recorder = Recorder::start(Kind::Apng, path.clone(), [16, 8], 25);
    for number in 0..4 {
        assert!(recorder.take(picture(number), number.into()));
    }
    assert_eq!(recorder.finish().unwrap(), 0);
    let decoder = png::Decoder::new(std::io::BufReader::new(std::fs::File::open(&path).unwrap()));
    let mut reader = decoder.read_info().unwrap();
    assert_eq!(reader.info().animation_control().unwrap().num_frames, 4);
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    for number in 0..4 {
        reader.next_frame(&mut bytes).unwrap();
        assert_eq!(bytes, picture(number).into_raw());
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "parts are left behind");
}

#[test]
fn a_sequence_is_numbered_and_a_bad_folder_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let mut recorder = Recorder::start(Kind::Sequence, folder.path().join("a/b"), [16, 8], 25);
    for number in 0..3 {
        assert!(recorder.take(picture(number), number.into()));
    }
    recorder.finish().unwrap();
    assert_eq!(image::open(folder.path().join("a/b/frame_00002.png")).unwrap().to_rgba8(), picture(2));
    let taken = folder.path().join("taken");
    std::fs::write(&taken, b"").unwrap();
    let mut recorder = Recorder::start(Kind::Sequence, taken.join("c"), [16, 8], 25);
    recorder.take(picture(0), 0);
    let error = recorder.finish().unwrap_err().to_string();
    assert!(error.contains("taken"), "{error}");
}
