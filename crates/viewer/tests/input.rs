//! Keys, mouse and triggers: what they do, to whom the keyboard belongs, and when a ruler overrides a trigger.

mod common;

use common::app_with;
use common::harness::{click, harness, open};
use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use policy_core::{Button, Goal};
use viewer::app::{App, PanelKind};

#[test]
fn tab_leaves_the_keyboard_to_the_game() {
    let mut harness = open(PanelKind::Physics);
    for _ in 0..3 {
        harness.key_press(egui::Key::Tab);
        harness.run_steps(2);
    }
    harness.key_down(egui::Key::W);
    harness.run_steps(2);
    harness.state_mut().advance(0.2);
    assert!(harness.state().input().left_stick[1] > 0.9, "{:?}", harness.state().input());
    assert!(harness.state().layout.hidden, "three times Tab hides, shows and hides");
}

#[test]
fn a_tap_shorter_than_a_frame_presses_a_button_for_a_tick() {
    let mut harness = open(PanelKind::Physics);
    let pressed = |harness: &Harness<'_, App>| harness.state().input().buttons.contains(Button::East);
    harness.key_press(egui::Key::R); // down and up between two frames
    harness.run_steps(2);
    harness.state_mut().advance(0.01);
    harness.run_steps(1);
    assert!(pressed(&harness), "less than a tick has passed");
    harness.state_mut().advance(0.05);
    harness.run_steps(1);
    assert!(!pressed(&harness), "the key is up again");
}

#[test]
fn a_number_can_still_be_typed() {
    let mut harness = open(PanelKind::Layers);
    harness.run_steps(2);
    harness.get_by_role_and_label(Role::TextInput, "Name").click();
    harness.run_steps(2);
    harness.key_down(egui::Key::W);
    harness.run_steps(2);
    harness.state_mut().advance(0.2);
    assert_eq!(harness.state().input().left_stick, [0.0; 2], "the letter is for the text field");
    // Escape leaves the field, and nothing else.
    harness.key_press(egui::Key::Escape);
    harness.run_steps(3);
    assert!(!harness.state().leaving && !harness.state().quit);
}

#[test]
fn escape_asks_before_it_leaves() {
    let mut harness = open(PanelKind::Record);
    let escape = |harness: &mut Harness<'_, App>| {
        harness.key_press(egui::Key::Escape);
        harness.run_steps(3);
    };
    escape(&mut harness);
    assert!(harness.state().leaving && !harness.state().quit);
    assert!(harness.query_by_role_and_label(Role::Button, "Stay (Esc)").is_some());
    escape(&mut harness);
    assert!(!harness.state().leaving && !harness.state().quit);
    escape(&mut harness);
    click(&mut harness, "Leave (Enter)");
    assert!(harness.state().quit);
}

#[test]
fn escape_closes_a_drop_down_and_nothing_else() {
    let mut harness = open(PanelKind::Layers);
    harness.run_steps(2);
    harness.get_by_role_and_label(Role::ComboBox, "0 is").click();
    harness.run_steps(3);
    assert!(egui::Popup::is_any_open(&harness.ctx), "the drop-down is open");
    harness.key_press(egui::Key::Escape);
    harness.run_steps(3);
    assert!(!egui::Popup::is_any_open(&harness.ctx));
    assert!(!harness.state().leaving && !harness.state().quit);
}

#[test]
fn a_trigger_takes_over_again_from_a_dragged_path() {
    let mut app = app_with(PanelKind::Paths);
    let speed = app.sim.pack().graph().path_named("speed").unwrap();
    app.pad.state.left_stick = [0.0, 1.0];
    app.pad.state.right_trigger = 0.5;
    app.apply(viewer::app::ViewerCommand::Goal(Some(Goal::Path { path: speed, coordinate: 1.0 })));
    app.tick();
    assert!(app.sim.overrides.goal.is_some(), "a trigger held still keeps the goal");
    app.pad.state.right_trigger = 0.1;
    app.tick();
    assert!(app.sim.overrides.goal.is_some(), "releasing the trigger keeps the goal");
    app.pad.state.right_trigger = 0.4;
    app.tick();
    assert_eq!(app.sim.overrides.goal, None);
}

#[test]
fn a_trigger_takes_over_again_from_the_sliders_of_the_layers() {
    let mut app = app_with(PanelKind::Layers);
    app.pad.state.left_trigger = 0.6;
    app.apply(viewer::app::ViewerCommand::Layers(viewer::app::Layers {
        active: true,
        t: [0.5; 3],
        ..app.layers.clone()
    }));
    app.tick();
    assert!(app.layers.active, "a trigger held still keeps the sliders");
    app.pad.state.left_trigger = 0.8;
    app.tick();
    assert!(!app.layers.active && app.layers.t == [0.5; 3], "the sliders stay where they were");
    app.tick();
    assert_eq!(app.sim.overrides.blend, None);
}

#[test]
fn keys_walk_help_and_hide() {
    let mut harness = open(PanelKind::Record);
    harness.key_down(egui::Key::W);
    harness.key_down(egui::Key::E);
    harness.run_steps(2);
    harness.state_mut().advance(0.2);
    let input = harness.state().input();
    assert!(input.left_stick[1] > 0.9 && input.right_trigger > 0.1 && input.right_trigger < 0.5, "{input:?}");
    harness.key_up(egui::Key::W);
    harness.key_up(egui::Key::E);
    harness.key_press(egui::Key::F1);
    harness.run_steps(3);
    assert!(harness.state().help);
    assert!(harness.query_by_label("Keyboard and mouse").is_some());
    harness.key_press(egui::Key::Tab);
    harness.run_steps(3);
    assert!(harness.state().layout.hidden);
    // A pad pulled out in mid-run leaves nothing behind.
    harness.state_mut().pad.state.left_stick = [1.0, 0.0];
    harness.state_mut().advance(0.1);
    harness.state_mut().pad = viewer::app::PadView::default();
    for _ in 0..10 {
        harness.state_mut().advance(0.1);
    }
    assert_eq!(harness.state().sim.player().command.target, None);
}

#[test]
fn dragging_a_body_pulls_it() {
    let mut app = app_with(PanelKind::Record);
    app.layout.hidden = true;
    app.clock.paused = true;
    let screen = egui::vec2(900.0, 700.0);
    let view = app.camera.view();
    let torso = app.sim.player().poses(1.0).positions[1];
    let clip = view.clip_from_world(screen.x / screen.y).project_point3(torso);
    let at = egui::pos2((clip.x * 0.5 + 0.5) * screen.x, (0.5 - clip.y * 0.5) * screen.y);
    let mut harness = harness(app);
    harness.run_steps(2);
    harness.drag_at(at);
    harness.run_steps(2);
    for step in 1..=8 {
        harness.hover_at(at + egui::vec2(15.0 * step as f32, 0.0));
        harness.run_steps(1);
    }
    let grab = harness.state().grab.expect("a body is held");
    // The camera looks along x: to the right on screen is towards negative y.
    assert!(grab.force().y < -20.0, "{grab:?}");
    for _ in 0..10 {
        harness.state_mut().tick();
    }
    assert!(harness.state().sim.player().position().y < -0.01, "{}", harness.state().sim.player().position());
    harness.drop_at(at);
    harness.run_steps(2);
    assert_eq!(harness.state().grab, None);
}

#[test]
fn a_press_beside_a_limb_turns_the_camera_alone_and_one_on_it_pulls_alone() {
    let mut app = app_with(PanelKind::Record);
    app.layout.hidden = true;
    app.clock.paused = true;
    let screen = egui::vec2(900.0, 700.0);
    let view = app.camera.view();
    let on_screen = |point: glam::Vec3| {
        let clip = view.clip_from_world(screen.x / screen.y).project_point3(point);
        egui::pos2((clip.x * 0.5 + 0.5) * screen.x, (0.5 - clip.y * 0.5) * screen.y)
    };
    let arm = app.sim.player().poses(1.0).positions
        [policy_core::Skeleton::humanoid().body_named("left_lower_arm").unwrap().index()];
    // The camera looks along x: 8 cm further to the left is beside the arm.
    for (at, pulls) in [(on_screen(arm + glam::Vec3::Y * 0.08), false), (on_screen(arm), true)] {
        let mut harness = harness(app_with(PanelKind::Record));
        harness.state_mut().layout.hidden = true;
        harness.state_mut().clock.paused = true;
        harness.run_steps(2);
        let yaw = harness.state().camera.yaw;
        harness.drag_at(at);
        harness.run_steps(2);
        // Towards the body, so that the mouse is over it once it is a drag.
        for step in 1..=6 {
            harness.hover_at(at + egui::vec2(8.0 * step as f32, 0.0));
            harness.run_steps(1);
        }
        let turned = (harness.state().camera.yaw - yaw).abs() > 1e-3;
        assert_eq!((harness.state().grab.is_some(), turned), (pulls, !pulls), "at {at}");
    }
}

#[test]
fn a_ruler_overrides_the_trigger_both_ways() {
    let mut harness = open(PanelKind::Paths);
    harness.run_steps(2);
    let path = harness.state().sim.pack().graph().path_named("speed").unwrap();
    // Dragging along the ruler asks for a coordinate.
    let name = harness.get_by_label("speed").rect();
    let y = name.bottom() + 20.0;
    harness.drag_at(egui::pos2(40.0, y));
    harness.run_steps(1);
    harness.hover_at(egui::pos2(150.0, y));
    harness.run_steps(2);
    harness.drop_at(egui::pos2(150.0, y));
    harness.run_steps(2);
    let Some(Goal::Path { path: asked, coordinate }) = harness.state().sim.overrides.goal else {
        panic!("no override: {:?}", harness.state().sim.overrides.goal);
    };
    assert!(asked == path && coordinate > 0.2, "{asked:?} {coordinate}");
    // The world follows the override ...
    let start = harness.state().sim.player().report().position;
    for _ in 0..15 {
        harness.state_mut().tick();
    }
    let now = harness.state().sim.player().report().position;
    assert!(now.t > start.t + 0.1, "from {start:?} to {now:?}");
    // ... until it is given back: then the trigger moves the cursor.
    click(&mut harness, "Back to the triggers");
    assert_eq!(harness.state().sim.overrides.goal, None);
    harness.state_mut().pad.state.left_stick = [0.0, 1.0];
    harness.state_mut().tick();
    let report = *harness.state().sim.player().report();
    let coordinate = harness.state().sim.pack().graph().path(path).coordinate(report.goal);
    assert_eq!(coordinate, Some(1.0));
}
