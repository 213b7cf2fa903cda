//! The playground without a window: props move, the course counts, balls hit, the past comes back.

mod common;

use std::sync::Arc;

use common::harness::harness;
use common::{FORWARD, playground, playground_config};
use egui_kittest::Harness;
use glam::{Vec2, Vec3};
use physics_bridge::{Motion, PropHandle};
use playground::RaceState;
use policy_core::{Buttons, CharacterPack, GamepadState, Heading};
use viewer::app::{App, Best, PanelLayout, ViewerCommand};
use viewer::assets;
use viewer::best_time::BestTime;
use viewer::sim::{
    Engine, GhostKind, GroundKind, Held, LooseKind, MOST_BALLS, SPAWN_BUTTON, SceneKind, SharedWorld,
    SimConfig, SimError, Simulation, THROW_BUTTON,
};

fn shared(sim: &Simulation) -> &SharedWorld {
    sim.shared().expect("a playground")
}

fn run(sim: &mut Simulation, pad: &GamepadState, ticks: usize) {
    for _ in 0..ticks {
        assert!(sim.tick(pad, Heading::FORWARD).is_empty());
        assert_eq!(sim.shared_mut().unwrap().take_put_right(), [] as [String; 0]);
    }
}

fn motion(sim: &Simulation, prop: PropHandle) -> Motion {
    shared(sim).world().motion(prop).unwrap()
}

#[test]
fn a_crate_moves_when_the_player_walks_into_it() {
    let mut sim = playground(1);
    let crate_ = shared(&sim).prop_named("crate_2").unwrap();
    run(&mut sim, &GamepadState::default(), 30);
    let start = motion(&sim, crate_).position;
    assert!((start.x - 4.6).abs() < 0.02, "it rests where the scene has it: {start}");
    for _ in 0..240 {
        run(&mut sim, &FORWARD, 1);
    }
    let moved = motion(&sim, crate_).position - start;
    assert!(moved.x > 0.2, "{moved}");
}

#[test]
fn the_race_counts_the_checkpoints_that_the_player_walks_through() {
    let mut sim = playground(1);
    assert_eq!(shared(&sim).race().state(), RaceState::Waiting);
    run(&mut sim, &FORWARD, 120);
    assert!(sim.player().position().x > 1.0, "{}", sim.player().position());
    let race = *shared(&sim).race();
    assert_eq!((race.state(), race.next()), (RaceState::Running, 1));
    let secs = race.secs(sim.tick_secs());
    assert!(secs > 0.0 && secs < 4.0, "{secs}");
    assert_eq!(sim.shared_mut().unwrap().take_events().len(), 1);
    sim.reset();
    assert_eq!(shared(&sim).race().state(), RaceState::Waiting);
    assert!(sim.player().position().length() < 0.05);
}

#[test]
fn a_thrown_ball_hits_and_old_balls_are_taken_out() {
    let mut sim = playground(2);
    run(&mut sim, &GamepadState::default(), 5);
    let target = sim.characters()[1].state.root().position + Vec3::Z * 0.2;
    let before = sim.characters()[1].position();
    let from = target + Vec3::new(-3.0, -3.0, 0.5);
    sim.shared_mut().unwrap().throw_at(from, target - from, 12.0).unwrap();
    let pushed = |sim: &Simulation| {
        let own = shared(sim).handle(1);
        let ball = shared(sim).pieces().last().unwrap().handle;
        let world = shared(sim).world();
        world.contacts().iter().any(|contact| {
            use physics_bridge::Part::{Body, Prop};
            matches!(contact.parts, [Prop(a), Body(b, _)] | [Body(b, _), Prop(a)] if a == ball && b == own)
        })
    };
    let mut hit = false;
    for _ in 0..30 {
        run(&mut sim, &GamepadState::default(), 1);
        hit |= pushed(&sim);
    }
    assert!(hit, "the ball met it, which stood at {before} and is at {}", sim.characters()[1].position());
    for throw in 0..2 * MOST_BALLS {
        let at = Vec3::new(-5.0, -10.0 + 0.2 * (throw % 20) as f32, 3.0);
        sim.shared_mut().unwrap().add_loose(LooseKind::Ball, Motion::at(at)).unwrap();
    }
    assert_eq!(shared(&sim).balls(), MOST_BALLS);
    let handles: Vec<PropHandle> = shared(&sim).pieces().iter().map(|piece| piece.handle).collect();
    assert!(handles.iter().all(|&handle| shared(&sim).world().motion(handle).is_ok()), "none is stale");
}

#[test]
fn the_pad_throws_a_ball_and_puts_a_prop_down_once_for_each_press() {
    let mut sim = playground(1);
    let scene = shared(&sim).pieces().len();
    let held = |button| GamepadState { buttons: Buttons::NONE.with(button), ..GamepadState::default() };
    run(&mut sim, &held(THROW_BUTTON), 5);
    assert_eq!((shared(&sim).balls(), shared(&sim).pieces().len()), (1, scene + 1));
    let ball = shared(&sim).pieces()[scene].handle;
    assert!(motion(&sim, ball).position.x > 1.5, "ahead of the player: {:?}", motion(&sim, ball));
    run(&mut sim, &held(SPAWN_BUTTON), 5);
    assert_eq!((shared(&sim).balls(), shared(&sim).pieces().len()), (1, scene + 2));
}

#[test]
fn others_wander_and_equal_seeds_wander_alike() {
    let run_of = |seed: u32| {
        let pack = Arc::new(CharacterPack::from_bytes(assets::HUMANOID_PACK).unwrap());
        let config = SimConfig { seed, history: false, ..playground_config(3) };
        let mut sim = Simulation::new(pack, config).unwrap();
        let starts: Vec<Vec2> = sim.characters().iter().map(|c| c.position()).collect();
        run(&mut sim, &GamepadState::default(), 300);
        let ways: Vec<f32> =
            sim.characters().iter().zip(&starts).map(|(c, start)| c.position().distance(*start)).collect();
        (sim.totals().hash, ways)
    };
    let (hash, ways) = run_of(1);
    assert!(ways[0] < 0.5, "the player has no input: {ways:?}");
    assert!(ways[1..].iter().any(|way| *way > 0.5), "{ways:?}");
    assert_eq!(run_of(1).0, hash);
    assert_ne!(run_of(2).0, hash);
}

#[test]
fn going_back_and_on_leads_to_the_same_place_for_all() {
    let mut sim = playground(3);
    let throw = GamepadState { buttons: Buttons::NONE.with(THROW_BUTTON), ..FORWARD };
    run(&mut sim, &FORWARD, 40);
    run(&mut sim, &throw, 5);
    run(&mut sim, &FORWARD, 45);
    let there =
        |sim: &Simulation| (shared(sim).world().save().hash(), *shared(sim).race(), shared(sim).balls());
    let end = there(&sim);
    assert_eq!(sim.history(), (90, 0));
    sim.rewind_to(60);
    assert_eq!(shared(&sim).balls(), 0, "not thrown yet");
    run(&mut sim, &FORWARD, 10);
    run(&mut sim, &throw, 5);
    run(&mut sim, &FORWARD, 45);
    assert_eq!(there(&sim), end);
    // What is placed begins a new past, for all of them.
    sim.stand_up(1);
    assert_eq!(sim.history(), (0, 0));
    run(&mut sim, &FORWARD, 5);
    sim.rewind_to(5);
    assert_eq!(sim.history(), (5, 5));
}

#[test]
fn a_prop_is_dragged_as_a_body_is() {
    let mut sim = playground(1);
    let ball = shared(&sim).prop_named("beach_ball").unwrap();
    run(&mut sim, &GamepadState::default(), 5);
    let to = motion(&sim, ball).position + Vec3::new(-1.0, 0.5, 0.8);
    for _ in 0..60 {
        sim.shared_mut().unwrap().hold(Some((Held::Prop(ball), to)));
        run(&mut sim, &GamepadState::default(), 1);
    }
    assert!(motion(&sim, ball).position.distance(to) < 0.3, "{:?}, {to}", motion(&sim, ball));
    sim.shared_mut().unwrap().hold(None);
    run(&mut sim, &GamepadState::default(), 30);
    assert!(motion(&sim, ball).position.z < 0.8, "it falls");
}

#[test]
fn the_pendulum_keeps_swinging() {
    let mut sim = playground(1);
    let bob = shared(&sim).prop_named("pendulum").unwrap();
    run(&mut sim, &GamepadState::default(), 600);
    let mut highest = 0.0_f32;
    for _ in 0..120 {
        run(&mut sim, &GamepadState::default(), 1);
        highest = highest.max(motion(&sim, bob).position.z);
    }
    assert!((1.4..2.1).contains(&highest), "{highest} m");
}

#[test]
fn what_diverges_is_put_right_and_the_rest_goes_on() {
    let pack = Arc::new(CharacterPack::from_bytes(assets::HUMANOID_PACK).unwrap());
    let mut app = App::new(Simulation::new(pack, playground_config(2)).unwrap(), PanelLayout::default());
    for _ in 0..10 {
        app.tick();
    }
    let torso = app.sim.pack().skeleton().body_named("torso").unwrap();
    app.sim.shared_mut().unwrap().impulse(1, torso, Vec3::X * 9e5);
    for _ in 0..30 {
        assert!(app.tick().is_empty(), "no failure stops the demo");
    }
    assert!(app.failure.is_none());
    let told = app.toasts.take_text().unwrap_or_default();
    assert!(app.put_right >= 1 && told.contains("diverged"), "{told}");
    assert!(app.sim.characters()[1].state.root().position.is_finite());
    assert_eq!(app.sim.totals().stood_up, 1);
}

#[test]
fn what_the_playground_is_not_for_is_refused_and_changes_nothing() {
    let mut sim = playground(2);
    run(&mut sim, &FORWARD, 5);
    for bad in [
        SimConfig { engine: Engine::Rapier, ..playground_config(2) },
        SimConfig { ground: GroundKind::Wavy, ..playground_config(2) },
        SimConfig { characters: 50, ..playground_config(2) },
    ] {
        assert!(sim.rebuild(bad).is_err(), "{bad:?}");
    }
    let ghost = sim.start_ghost(GhostKind::Engine(Engine::Rapier));
    assert!(matches!(ghost, Err(SimError::NotInPlayground { .. })), "{ghost:?}");
    assert_eq!((sim.characters().len(), sim.ticks()), (2, 5));
    let settings = physics_bridge::Settings { gravity: 0.3, strength: 1.2, ..Default::default() };
    sim.set_settings(settings).unwrap();
    assert_eq!(shared(&sim).world().ground().settings().gravity, 0.3);
    run(&mut sim, &FORWARD, 5);
}

#[test]
fn scenes_change_while_the_demo_runs() {
    let mut app = App::new(common::simulation(), PanelLayout::default());
    app.apply(ViewerCommand::Throw { from: Vec3::Z, along: Vec3::X });
    assert!(app.toasts.take_text().is_some_and(|notice| notice.contains("playground")));
    app.apply(ViewerCommand::Ground(GroundKind::Wavy));
    app.apply(ViewerCommand::Scene(SceneKind::Playground));
    assert_eq!((app.toasts.take_text(), app.sim.characters().len()), (None, 5));
    app.apply(ViewerCommand::Throw { from: Vec3::new(-3.0, 0.0, 1.5), along: Vec3::X });
    app.apply(ViewerCommand::Spawn { from: Vec3::new(-3.0, 0.0, 1.5), along: Vec3::new(1.0, 0.0, -0.5) });
    for _ in 0..20 {
        app.tick();
    }
    assert_eq!((shared(&app.sim).balls(), app.toasts.take_text()), (1, None));
    app.apply(ViewerCommand::Reset);
    assert_eq!(shared(&app.sim).balls(), 0);
    app.apply(ViewerCommand::Ground(GroundKind::Wavy));
    assert!(app.toasts.take_text().is_some_and(|notice| notice.contains("flat ground")));
    app.apply(ViewerCommand::Scene(SceneKind::Empty));
    assert_eq!((app.toasts.take_text(), app.sim.characters().len()), (None, 1));
    assert!(app.sim.shared().is_none());
}

/// The playground in a window of 900 x 700 points, with no panel in the way.
fn window() -> Harness<'static, App> {
    let layout = PanelLayout { hidden: true, ..PanelLayout::default() };
    let mut harness = harness(App::new(playground(1), layout));
    harness.run_steps(2);
    harness
}

#[test]
fn keys_throw_a_ball_at_the_mouse_and_put_a_prop_there() {
    let mut harness = window();
    let pieces = shared(&harness.state().sim).pieces().len();
    harness.hover_at(egui::pos2(450.0, 300.0));
    harness.key_press(egui::Key::T);
    harness.run_steps(2);
    assert_eq!(shared(&harness.state().sim).balls(), 1);
    harness.key_press(egui::Key::Y);
    harness.run_steps(2);
    assert_eq!(shared(&harness.state().sim).pieces().len(), pieces + 2);
    assert!(harness.state().toasts.is_empty());
}

#[test]
fn the_mouse_drags_a_prop() {
    let mut harness = window();
    let barrel = shared(&harness.state().sim).prop_named("barrel_1").unwrap();
    let start = motion(&harness.state().sim, barrel).position;
    let clip = harness.state().camera.view().clip_from_world(900.0 / 700.0).project_point3(start);
    let at = egui::pos2((clip.x * 0.5 + 0.5) * 900.0, (0.5 - clip.y * 0.5) * 700.0);
    harness.drag_at(at);
    harness.run_steps(2);
    for step in 1..=10 {
        harness.hover_at(at - egui::vec2(0.0, 12.0 * step as f32));
        harness.run_steps(1);
    }
    let grab = harness.state().grab.expect("the barrel is held");
    assert_eq!(grab.held, Held::Prop(barrel));
    for _ in 0..20 {
        harness.state_mut().tick();
    }
    let moved = motion(&harness.state().sim, barrel).position - start;
    assert!(moved.z > 0.2, "it is lifted: {moved}");
    harness.drop_at(at);
    harness.run_steps(2);
    assert_eq!(harness.state().grab, None);
}

#[test]
fn a_finished_race_keeps_its_best_time_beside_the_settings() {
    let folder = tempfile::tempdir().unwrap();
    let mut app = App::new(playground(1), PanelLayout::default());
    app.best = Best::beside(folder.path().join("layout.ron"));
    let checkpoints = shared(&app.sim).scene().checkpoints.clone();
    // Carried from one checkpoint to the next.
    for checkpoint in &checkpoints {
        assert!(app.sim.carry(0, checkpoint.at));
        app.tick();
    }
    assert_eq!(shared(&app.sim).race().state(), RaceState::Finished);
    let best = app.best.time().expect("a best time");
    assert!((best.secs - (checkpoints.len() - 1) as f32 * app.sim.tick_secs()).abs() < 1e-4, "{best:?}");
    let file = BestTime::file_beside(&folder.path().join("layout.ron"), "playground");
    assert_eq!(BestTime::load(&file).unwrap(), Some(best));
}

#[test]
fn the_tour_follows_the_way_from_the_start_and_runs_for_no_best_time() {
    let mut app = App::new(playground(1), PanelLayout::default());
    let checkpoints = shared(&app.sim).scene().checkpoints.clone();
    assert!(app.sim.carry(0, Vec2::new(-4.0, -4.0)));
    app.tour.start();
    app.tick();
    assert!(app.sim.player().position().length() < 0.5, "{}", app.sim.player().position());
    // The first point of the way is straight ahead, wherever the camera looks from.
    app.camera.turn(Vec2::new(1.0, 0.0));
    for _ in 0..90 {
        app.tick();
    }
    assert_eq!(shared(&app.sim).race().state(), RaceState::Running);
    for checkpoint in &checkpoints {
        assert!(app.sim.carry(0, checkpoint.at));
        app.tick();
    }
    assert_eq!(shared(&app.sim).race().state(), RaceState::Finished);
    assert_eq!(app.best.time(), None);
    // It can't come back to the point that it was on the way to, so it begins anew.
    let stuck = (0..1200).find(|_| {
        app.sim.carry(0, Vec2::new(21.0, -10.0));
        app.tick();
        app.sim.player().position().length() < 0.5
    });
    assert!(stuck.is_some());
}

#[test]
fn the_camera_stays_before_walls_and_other_characters() {
    let mut app = App::new(playground(2), PanelLayout::default());
    let distance_at = |app: &mut App, at: Vec2| {
        assert!(app.sim.carry(0, at));
        app.camera.reset(Heading::FORWARD);
        (0..300).for_each(|_| app.follow(1.0 / 60.0, 1.0));
        let view = app.camera.view();
        view.target.distance(view.eye)
    };
    let (open, beside_the_gate) = (Vec2::new(21.0, -8.0), Vec2::new(20.0, 2.0));
    let free = distance_at(&mut app, open);
    assert!((free - 3.6).abs() < 0.05, "nothing is in the way: {free} m");
    // Its wall is at x = 19, from 0.8 to 3.2 m in y.
    let near = distance_at(&mut app, beside_the_gate);
    assert!((0.55..0.95).contains(&near), "a wall 0.9 m behind it: {near} m");
    assert!(app.sim.carry(1, open - 1.8 * Vec2::X));
    let near = distance_at(&mut app, open);
    assert!((0.9..1.8).contains(&near), "another character 1.8 m behind it: {near} m");
}
