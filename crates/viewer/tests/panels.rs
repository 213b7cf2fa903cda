//! Every panel: widgets found by label, driven as a user would, the demo's state asserted.

mod common;

use common::app_with;
use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use policy_core::{Blend, BlendMode, Button, Goal, NodeId, SkillId};
use viewer::analysis::Analysis;
use viewer::app::{App, Failure, PanelKind, Preset, Record, Side};
use viewer::camera::CameraMode;
use viewer::sim::GroundKind;

fn harness(app: App) -> Harness<'static, App> {
    Harness::builder()
        .with_size(egui::vec2(900.0, 700.0))
        .build_ui_state(|ui, app: &mut App| app.ui(ui, 0.0), app)
}

fn open(kind: PanelKind) -> Harness<'static, App> {
    harness(app_with(kind))
}

/// Clicks what carries `label` and lets two frames pass.
fn click(harness: &mut Harness<'_, App>, label: &str) {
    harness.get_by_role_and_label(Role::Button, label).click();
    harness.run_steps(2);
}

#[test]
fn the_bar_opens_closes_and_panels_change_sides() {
    let mut harness = open(PanelKind::Record);
    click(&mut harness, "Analysis");
    assert!(harness.state().layout.side_of(PanelKind::Analysis).is_some());
    click(&mut harness, "Analysis");
    assert_eq!(harness.state().layout.side_of(PanelKind::Analysis), None);
    click(&mut harness, "<>");
    assert_eq!(harness.state().layout.side_of(PanelKind::Record), Some(Side::Right));
    click(&mut harness, "x");
    assert_eq!(harness.state().layout.side_of(PanelKind::Record), None);
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

#[test]
fn the_graph_sends_the_character_to_a_node() {
    let mut harness = open(PanelKind::Graph);
    harness.run_steps(2);
    click(&mut harness, "walk");
    let walk = harness.state().sim.pack().graph().node_named("walk").unwrap();
    assert_eq!(harness.state().sim.overrides.goal, Some(Goal::Node(walk)));
    for _ in 0..120 {
        harness.state_mut().tick();
    }
    assert_eq!(harness.state().sim.player().report().position.as_node(), Some(walk));
}

#[test]
fn layers_blend_by_hand_and_presets_come_back() {
    let mut harness = open(PanelKind::Layers);
    harness.run_steps(2);
    harness.get_by_role_and_label(Role::RadioButton, "Manual").click();
    harness.run_steps(2);
    assert!(!harness.state().layers.automatic);
    harness.get_by_role_and_label(Role::CheckBox, "Sliders instead of the triggers").click();
    harness.run_steps(2);
    assert!(harness.state().layers.active);
    harness.state_mut().layers.t = [0.25, 0.5, 1.0];
    harness.state_mut().tick();
    let blend = harness.state().sim.player().report().blend;
    assert_eq!(blend.terms()[1].weights[..3], [0.25, 0.5, 1.0]);
    click(&mut harness, "Save preset");
    let preset =
        Preset { name: "my blend".into(), from: "idle".into(), to: "walk".into(), t: [0.25, 0.5, 1.0] };
    let saved = &harness.state().layout.presets[0];
    assert_eq!((saved.t, &saved.name), (preset.t, &preset.name));
    click(&mut harness, "Reset layers");
    assert_eq!(harness.state().layers.t, [0.0; 3]);
    click(&mut harness, "my blend");
    assert_eq!(harness.state().layers.t, [0.25, 0.5, 1.0]);
}

#[test]
fn the_blend_mode_changes_and_a_ghost_comes_and_goes() {
    let mut harness = open(PanelKind::BlendMode);
    harness.run_steps(2);
    harness.get_by_role_and_label(Role::RadioButton, "actions").click();
    harness.run_steps(2);
    assert_eq!(harness.state().sim.blend_mode(), BlendMode::Actions);
    click(&mut harness, "ghost: switch");
    assert_eq!(harness.state().sim.ghost().map(|g| g.mode()), Some(BlendMode::Switch));
    harness.state_mut().tick();
    click(&mut harness, "no ghost");
    assert!(harness.state().sim.ghost().is_none());
}

#[test]
fn the_skills_panel_starts_a_skill_or_says_there_is_none() {
    let mut harness = open(PanelKind::Skills);
    harness.run_steps(2);
    let skills: Vec<String> = harness.state().sim.pack().skills().iter().map(|s| s.name.clone()).collect();
    match skills.first() {
        None => assert!(harness.query_by_label("This pack has no episodic skills.").is_some()),
        Some(name) => {
            click(&mut harness, name);
            assert_eq!(harness.state().sim.overrides.skill, Some(SkillId::new(0)));
            harness.state_mut().tick();
            let report = harness.state().sim.player().report();
            // A skill to get up is refused while the character is up, which the status line says.
            let refused = report.skill_refused.is_some() && harness.state().refused().is_some();
            assert!(report.skill.is_some() || report.pending_skill == Some(SkillId::new(0)) || refused);
        }
    }
}

#[test]
fn the_pad_panel_says_what_is_held_and_what_is_wrong() {
    let mut harness = open(PanelKind::Pad);
    harness.run_steps(2);
    assert!(harness.query_by_label("No pad; the keyboard steers.").is_some());
    let pad = &mut harness.state_mut().pad;
    pad.name = Some("Test pad through Hid".into());
    pad.state.buttons.set(Button::East, true);
    pad.problems.push("no permission for /dev/hidraw7".into());
    harness.run_steps(2);
    assert!(harness.query_by_label("Test pad through Hid").is_some());
    assert!(harness.query_by_label("buttons: East").is_some());
    assert!(harness.query_by_label("no permission for /dev/hidraw7").is_some());
}

#[test]
fn the_analysis_shows_points_of_every_policy() {
    let mut app = app_with(PanelKind::Analysis);
    let analysis = Analysis::of(app.sim.pack()).unwrap();
    let policies = app.sim.pack().policies().len();
    for node in 0..policies {
        let id = NodeId::new(node);
        assert!(analysis.cloud.iter().any(|p| p.node == id), "no point of policy {node}");
        // A blend of one policy alone lies on its node.
        let blend = Blend::single(id.into());
        let apart = analysis.parameters.blend(&blend).distance(analysis.parameters.nodes[node]);
        assert!(apart < 1e-3, "{apart}");
    }
    app.analysis = Some(analysis);
    app.tick();
    assert_eq!(app.analysis.as_ref().unwrap().trail.len(), 1);
    let mut harness = harness(app);
    harness.run_steps(2);
    assert!(harness.query_by_label("Parameters: policies, edges, your blend").is_some());
}

#[test]
fn physics_pauses_steps_goes_back_and_changes_the_ground() {
    let mut harness = open(PanelKind::Physics);
    harness.run_steps(2);
    click(&mut harness, "Pause");
    assert!(harness.state().clock.paused);
    let before = harness.state().sim.ticks();
    click(&mut harness, "Step");
    harness.state_mut().advance(0.01);
    assert_eq!(harness.state().sim.ticks(), before + 1);
    for _ in 0..10 {
        harness.state_mut().tick();
    }
    let here = harness.state().sim.player().state.clone();
    harness.state_mut().tick();
    click(&mut harness, "Step back");
    assert_eq!(harness.state().sim.player().state, here);
    assert_eq!(harness.state().sim.history().1, 1);
    click(&mut harness, "wavy");
    assert_eq!(harness.state().sim.config().ground, GroundKind::Wavy);
    assert!(harness.state().sim.model().height_field().is_some());
    click(&mut harness, "Play");
    assert!(!harness.state().clock.paused);
    click(&mut harness, "Reset");
    assert!(harness.state().sim.player().position().length() < 0.1);
}

#[test]
fn play_goes_on_after_stepping_back_and_scrubbing() {
    let mut harness = open(PanelKind::Physics);
    for _ in 0..30 {
        harness.state_mut().tick();
    }
    harness.run_steps(2);
    for back in 1..=7 {
        click(&mut harness, "Step back");
        assert_eq!(harness.state().sim.history().1, back);
    }
    click(&mut harness, "Play");
    harness.run_steps(3);
    assert!(!harness.state().clock.paused, "the slider has paused it again");
    let before = harness.state().sim.ticks();
    harness.state_mut().advance(0.2);
    assert!(harness.state().sim.ticks() > before);
}

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
    assert!(app.sim.overrides.goal.is_some(), "a trigger that is held still is no wish");
    app.pad.state.right_trigger = 0.1;
    app.tick();
    assert!(app.sim.overrides.goal.is_some(), "nor is one that is let go");
    app.pad.state.right_trigger = 0.4;
    app.tick();
    assert_eq!(app.sim.overrides.goal, None);
}

#[test]
fn the_status_line_says_what_the_layers_blend() {
    let mut harness = open(PanelKind::Layers);
    harness.state_mut().layers = viewer::app::Layers {
        active: true,
        automatic: false,
        t: [0.25, 0.5, 1.0],
        ..harness.state().layers.clone()
    };
    harness.state_mut().tick();
    let place = viewer::app::place(harness.state());
    assert_eq!(place, "layers: idle - walk 25, 50, 100 %");
}

#[test]
fn help_fits_the_window() {
    for size in [egui::vec2(1280.0, 720.0), egui::vec2(800.0, 500.0)] {
        let mut app = app_with(PanelKind::Record);
        app.help = true;
        let mut harness =
            Harness::builder().with_size(size).build_ui_state(|ui, app: &mut App| app.ui(ui, 0.0), app);
        harness.run_steps(4);
        let rect = harness.ctx.memory(|m| m.area_rect(egui::Id::unique("help"))).unwrap();
        assert!(rect.top() >= 0.0 && rect.bottom() <= size.y, "{rect} in {size}");
    }
}

#[test]
fn panels_leave_a_view_however_small_the_window() {
    for (width, least) in [(1280.0, 400.0), (800.0, 400.0), (640.0, 300.0), (320.0, 320.0)] {
        let layout = viewer::app::PanelLayout::default();
        let app = App::new(common::simulation(), layout);
        let mut harness = Harness::builder()
            .with_size(egui::vec2(width, 480.0))
            .build_ui_state(|ui, app: &mut App| app.ui(ui, 0.0), app);
        harness.run_steps(3);
        let free = harness.ctx.content_rect().width() - side_widths(&harness);
        assert!(free >= least, "{width}: {free} are left");
    }
}

/// Width of the columns of panels.
fn side_widths(harness: &Harness<'_, App>) -> f32 {
    let width = |id: &str| {
        egui::containers::panel::PanelState::load(&harness.ctx, egui::Id::unique(id))
            .map_or(0.0, |s| s.outer_rect.width())
    };
    width("left") + width("right")
}

#[test]
fn the_view_panel_switches_what_is_shown_and_the_camera() {
    let mut harness = open(PanelKind::View);
    harness.run_steps(2);
    harness.get_by_role_and_label(Role::CheckBox, "Collision shapes").click();
    harness.run_steps(2);
    assert!(harness.state().layout.shown.collision_shapes);
    click(&mut harness, "fixed");
    assert_eq!(
        (harness.state().camera.mode, harness.state().layout.camera),
        (CameraMode::Fixed, CameraMode::Fixed)
    );
}

#[test]
fn the_profiler_shows_numbers_and_the_recorder_is_asked() {
    let mut harness = open(PanelKind::Profiler);
    harness.state_mut().tick();
    harness.run_steps(2);
    assert!(harness.query_by_label_contains("real-time factor").is_some());
    assert!(harness.state().plots.physics.last().unwrap() > 0.0);
    let mut harness = open(PanelKind::Record);
    harness.run_steps(2);
    click(&mut harness, "Screenshot");
    assert_eq!(harness.state().record, Some(Record::Screenshot));
    click(&mut harness, "Film");
    assert_eq!(harness.state().record, Some(Record::Video));
}

#[test]
fn a_failure_offers_rewind_and_reset() {
    let mut app = app_with(PanelKind::Record);
    for _ in 0..90 {
        app.tick();
    }
    let ticks = app.sim.ticks();
    app.failure =
        Some(Failure { what: "it blew up".into(), replay: Some("x.json".into()), characters: vec![0] });
    app.advance(1.0);
    assert_eq!(app.sim.ticks(), ticks, "a failed demo must wait");
    let mut harness = harness(app);
    harness.run_steps(2);
    assert!(harness.query_by_label("it blew up").is_some());
    click(&mut harness, "Rewind and continue");
    assert_eq!(harness.state().failure, None);
    assert_eq!(harness.state().sim.history().1, 60);
    harness.state_mut().failure = Some(Failure { what: "again".into(), replay: None, characters: vec![0] });
    harness.run_steps(2);
    click(&mut harness, "Start again");
    assert!(harness.state().failure.is_none() && harness.state().sim.player().position().length() < 0.1);
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
    let view = app.camera.view(0.0);
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
    let view = app.camera.view(0.0);
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
