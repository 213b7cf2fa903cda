//! A newcomer's first minute: the simple layout, first steps, settings, messages, the tour, cameras.

mod common;

use common::harness::{click, harness, harness_of, open};
use common::{app_with, simulation};
use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use policy_core::{Button, GamepadState};
use viewer::app::{
    App, FirstStep, Grab, IDLE_SECS, KeptLayout, KeyAction, PanelKind, PanelLayout, Preferences, Quality,
    ViewerCommand,
};
use viewer::camera::CameraMode;
use viewer::sim::Held;

/// The demo as it is at the first start.
fn app() -> App {
    App::new(simulation(), PanelLayout::default())
}

#[test]
fn the_first_start_is_simple_and_advanced_is_remembered() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("layout.ron");
    let mut harness = harness(app());
    harness.run_steps(2);
    assert!(harness.query_by_role_and_label(Role::Button, "Paths").is_none());
    assert!(harness.query_by_label("Blending weights").is_some());
    let mut kept = KeptLayout::new(path.clone(), &harness.state().layout);
    harness.get_by_role_and_label(Role::CheckBox, "Advanced").click();
    harness.run_steps(2);
    assert!(harness.query_by_role_and_label(Role::Button, "Paths").is_some());
    assert!(harness.query_by_label("Blending weights").is_none());
    kept.keep(&harness.state().layout).unwrap();
    assert!(PanelLayout::load(&path).unwrap().preferences.advanced);
}

/// The harness's own margin, points.
const FRAME: f32 = 20.0;

#[test]
fn the_simple_layout_leaves_a_view_in_a_small_window() {
    for size in [egui::vec2(1280.0, 720.0), egui::vec2(640.0, 480.0)] {
        let mut harness = harness_of(app(), size);
        harness.run_steps(3);
        let free = harness.state().free;
        assert!(free.height() > 0.6 * size.y && free.height() < size.y - 40.0, "{free} of {size}");
        assert!(free.width() > size.x - FRAME, "{free} of {size}");
    }
}

/// Words of the method that a player need not know.
#[test]
fn the_simple_layout_has_words_that_a_player_knows() {
    let mut app = app();
    app.choosing = true;
    let mut harness = harness(app);
    harness.run_steps(3);
    for word in ["parameter", "policy", "node", "coordinate", "discriminator"] {
        for text in [Role::Label, Role::Button, Role::CheckBox, Role::Slider]
            .into_iter()
            .flat_map(|role| harness.query_all_by_role(role))
            .filter_map(|node| node.accesskit_node().label().or_else(|| node.accesskit_node().value()))
        {
            assert!(!text.to_lowercase().contains(word), "{text}");
        }
    }
}

/// Ticks until a step is done, for ten seconds at most.
fn until_done(app: &mut App, step: FirstStep) {
    for _ in 0..300 {
        assert!(app.tick().is_empty());
        if app.first_steps.is_done(step) {
            return;
        }
    }
    panic!("{step:?} is not done: {:?}", app.first_steps);
}

#[test]
fn the_first_steps_are_ticked_off_by_playing() {
    let mut app = app();
    app.pad.state.left_stick = [0.0, 1.0];
    until_done(&mut app, FirstStep::Move);
    assert!(!app.first_steps.is_done(FirstStep::Run));
    app.pad.state.right_trigger = 1.0;
    until_done(&mut app, FirstStep::Run);
    app.pad.state = GamepadState { left_trigger: 1.0, ..GamepadState::default() };
    until_done(&mut app, FirstStep::Crouch);
    app.apply(ViewerCommand::Reset);
    app.pad.state = GamepadState { left_stick: [0.0, 1.0], ..GamepadState::default() };
    (0..60).for_each(|_| assert!(app.tick().is_empty()));
    app.pad.state.buttons.set(Button::East, true);
    until_done(&mut app, FirstStep::Roll);
    let body = app.sim.pack().skeleton().root();
    app.grab = Some(Grab { held: Held::Body(0, body), pull: glam::Vec3::Y * 0.1 });
    until_done(&mut app, FirstStep::Pull);
    app.grab = None;
    // The list stays for a moment, then it is gone for good.
    assert!(app.layout.preferences.shows_first_steps);
    (0..150).for_each(|_| drop(app.tick()));
    app.advance(0.01);
    assert!(!app.layout.preferences.shows_first_steps);
}

#[test]
fn the_list_of_first_steps_can_be_closed_for_good_and_shown_again() {
    let mut harness = harness(app());
    harness.run_steps(3);
    assert!(harness.query_by_label("Pull me").is_some() && harness.query_by_label("hold Q").is_some());
    click(&mut harness, "x");
    assert!(!harness.state().layout.preferences.shows_first_steps);
    assert!(harness.query_by_label("Pull me").is_none());
    click(&mut harness, "Settings (F4)");
    harness.run_steps(2);
    click(&mut harness, "Show the first steps again");
    assert!(harness.state().layout.preferences.shows_first_steps);
}

#[test]
fn settings_hold_at_once_and_go_back_to_the_defaults() {
    let mut harness = harness_of(app(), egui::vec2(900.0, 1100.0));
    harness.state_mut().layout.presets.push(viewer::app::Preset {
        name: "mine".into(),
        from: "idle".into(),
        to: "walk".into(),
        t: [0.5; 3],
    });
    harness.key_press(egui::Key::F4);
    harness.run_steps(3);
    click(&mut harness, "low");
    click(&mut harness, "first person");
    harness.get_by_role_and_label(Role::CheckBox, "Invert up and down").click();
    harness.run_steps(2);
    click(&mut harness, "125 %");
    harness.run_steps(2);
    let preferences = harness.state().layout.preferences;
    assert_eq!((preferences.quality, preferences.ui_scale), (Quality::Low, 1.25));
    assert_eq!(harness.ctx.zoom_factor(), 1.25);
    assert!(preferences.inverts_y && harness.state().camera.mode == CameraMode::FirstPerson);
    let pitch = harness.state().camera.pitch;
    harness.state_mut().apply(ViewerCommand::Turn(glam::Vec2::new(0.0, 0.1)));
    assert!(harness.state().camera.pitch < pitch, "up and down are turned over");
    harness.state_mut().apply(ViewerCommand::ResetPreferences);
    harness.run_steps(2);
    let layout = &harness.state().layout;
    assert_eq!((layout.preferences, layout.camera), (Preferences::default(), CameraMode::default()));
    assert_eq!((harness.ctx.zoom_factor(), layout.presets.len()), (1.0, 1));
}

#[test]
fn a_key_can_be_given_to_another_action() {
    let mut harness = harness_of(app(), egui::vec2(900.0, 1100.0));
    harness.state_mut().choosing = true;
    harness.run_steps(3);
    // A key of the demo itself is refused.
    for (key, bound) in
        [(egui::Key::P, egui::Key::R), (egui::Key::Escape, egui::Key::R), (egui::Key::H, egui::Key::H)]
    {
        harness.get_by_role_and_label(Role::Button, "R").click();
        harness.run_steps(2);
        assert_eq!(harness.state().rebinding, Some(KeyAction::Roll));
        harness.key_press(key);
        harness.run_steps(2);
        let app = harness.state();
        assert_eq!((app.rebinding, app.layout.preferences.keys.key(KeyAction::Roll)), (None, bound));
        assert!(!app.clock.paused && !app.leaving && app.choosing);
    }
    harness.key_down(egui::Key::H);
    harness.run_steps(1);
    assert!(harness.state().input().buttons.contains(Button::East));
    // The help says so.
    let help = viewer::app::key_help(&harness.state().layout.preferences.keys);
    assert!(help.contains(&("H".to_owned(), "roll")), "{help:?}");
}

#[test]
fn messages_fade_and_errors_have_another_colour() {
    let mut harness = harness(app());
    harness.state_mut().toasts.note("all is well");
    harness.state_mut().apply(ViewerCommand::Characters(100_000));
    harness.run_steps(3);
    assert!(harness.query_by_label("all is well").is_some());
    assert!(harness.query_by_label_contains("expected 1 to 200 characters").is_some());
    harness.state_mut().clock.paused = true;
    (0..60).for_each(|_| harness.state_mut().advance(0.1));
    harness.run_steps(2);
    assert!(harness.query_by_label("all is well").is_none());
    assert!(harness.query_by_label_contains("expected 1 to 200").is_some(), "errors stay longer");
    harness.state_mut().layout.preferences.shows_first_steps = false;
    harness.run_steps(2);
    click(&mut harness, "x");
    assert!(harness.state().toasts.is_empty());
}

/// Lets a little more than the tour's patience pass, in slow motion.
fn wait(app: &mut App) {
    app.clock.speed = 1.0 / 32.0;
    (0..(IDLE_SECS * 4.0) as usize + 4).for_each(|_| app.advance(0.25));
}

#[test]
fn the_tour_plays_when_nobody_steers_and_ends_with_the_first_key() {
    let mut harness = harness(app());
    wait(harness.state_mut());
    harness.run_steps(2);
    assert!(harness.state().tour.is_playing());
    assert!(harness.query_by_label_contains("Tour: press any key").is_some());
    (0..150).for_each(|_| drop(harness.state_mut().tick()));
    assert!(harness.state().input().left_stick[1] > 0.9);
    assert!(!harness.state().first_steps.is_done(FirstStep::Move), "the tour is not the player");
    harness.key_press(egui::Key::A);
    harness.run_steps(2);
    assert!(!harness.state().tour.is_playing());
    // Neither while it is paused, nor where it is not wanted.
    harness.state_mut().clock.paused = true;
    wait(harness.state_mut());
    assert!(!harness.state().tour.is_playing());
    harness.state_mut().clock.paused = false;
    harness.state_mut().layout.preferences.plays_tour = false;
    wait(harness.state_mut());
    assert!(!harness.state().tour.is_playing());
}

#[test]
fn the_cameras_go_round_and_come_back() {
    let mut harness = harness(app());
    let mut seen = Vec::new();
    for _ in CameraMode::ALL {
        harness.key_press(egui::Key::C);
        harness.run_steps(2);
        harness.state_mut().follow(0.5, 1.0);
        seen.push(harness.state().camera.mode);
        let view = harness.state().camera.view();
        assert!(view.eye.is_finite() && view.eye.distance(view.target) > 0.1, "{view:?}");
        if seen.last() == Some(&CameraMode::FirstPerson) {
            let head = harness.state().sim.pack().skeleton().head().unwrap();
            let head = harness.state().sim.poses(0, 1.0).positions[head.index()];
            assert!(view.eye.distance(head) < 0.3, "{view:?} and {head}");
        }
    }
    assert!(CameraMode::ALL.iter().all(|mode| seen.contains(mode)), "{seen:?}");
    // The arrow keys fly a free camera and leave the character alone.
    harness.state_mut().apply(ViewerCommand::Camera(CameraMode::Free));
    let eye = harness.state().camera.view().eye;
    harness.key_down(egui::Key::ArrowUp);
    harness.run_steps(2);
    harness.state_mut().advance(0.1);
    assert!(harness.state().camera.view().eye.distance(eye) > 0.2);
    assert_eq!(harness.state().input().left_stick, [0.0; 2]);
    harness.key_up(egui::Key::ArrowUp);
    harness.key_press(egui::Key::Home);
    harness.run_steps(2);
    assert_eq!(harness.state().camera.mode, CameraMode::Follow);
}

/// Names of the controls without a tooltip.
fn untold(harness: &Harness<'_, App>) -> Vec<String> {
    let roles =
        [Role::Button, Role::CheckBox, Role::RadioButton, Role::Slider, Role::ComboBox, Role::TextInput];
    roles
        .into_iter()
        .flat_map(|role| harness.query_all_by_role(role))
        .map(|node| node.accesskit_node())
        .filter(|node| node.description().is_none_or(|told| told.is_empty()))
        // This one is egui's own.
        .filter(|node| node.label().as_deref() != Some("Close window"))
        .map(|node| format!("{:?} {:?}", node.role(), node.label()))
        .collect()
}

#[test]
fn every_control_has_a_tooltip() {
    for kind in PanelKind::ALL {
        let mut harness = open(kind);
        harness.state_mut().layout.presets.push(viewer::app::Preset {
            name: "mine".into(),
            from: "idle".into(),
            to: "walk".into(),
            t: [0.5; 3],
        });
        harness.run_steps(3);
        assert_eq!(untold(&harness), [""; 0], "{kind:?}");
    }
    let mut simple = app();
    (simple.choosing, simple.leaving) = (true, true);
    simple.toasts.note("all is well");
    let mut harness = harness_of(simple, egui::vec2(900.0, 1100.0));
    harness.run_steps(3);
    assert_eq!(untold(&harness), [""; 0]);
    assert!(app_with(PanelKind::Pad).layout.preferences.advanced);
}
