//! Every panel: widgets found by label, driven as a user would, the demo's state asserted.

mod common;

use common::app_with;
use common::harness::{click, harness, open};
use egui::accesskit::Role;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use policy_core::{Blend, BlendMode, Button, Goal, NodeId, SkillId};
use viewer::analysis::Analysis;
use viewer::app::{Failure, PanelKind, Preset, Record, ViewerCommand};
use viewer::camera::CameraMode;
use viewer::sim::{Engine, GhostKind, GroundKind};

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
    assert_eq!(harness.state().sim.ghost().map(|g| g.kind()), Some(GhostKind::Mode(BlendMode::Switch)));
    harness.state_mut().tick();
    click(&mut harness, "no ghost");
    assert!(harness.state().sim.ghost().is_none());
}

#[test]
fn the_physics_panel_changes_the_engine_and_greys_what_it_lacks() {
    let mut harness = open(PanelKind::Physics);
    harness.run_steps(2);
    harness.get_by_role_and_label(Role::CheckBox, "Ghost in Rapier").click();
    harness.run_steps(2);
    let ghost = |harness: &egui_kittest::Harness<'_, _>| {
        let app: &viewer::app::App = harness.state();
        app.sim.ghost().map(|g| g.kind())
    };
    assert_eq!(ghost(&harness), Some(GhostKind::Engine(Engine::Rapier)));
    assert!(!harness.get_by_role_and_label(Role::Button, "Step back").accesskit_node().is_disabled());
    click(&mut harness, "Rapier");
    assert_eq!((harness.state().sim.engine(), ghost(&harness)), (Engine::Rapier, None));
    assert!(harness.get_by_role_and_label(Role::Button, "Step back").accesskit_node().is_disabled());
    harness.state_mut().apply(ViewerCommand::StepBack);
    assert!(
        !harness.state().clock.paused && harness.state_mut().toasts.take_text().unwrap().contains("Rapier")
    );
    harness.get_by_role_and_label(Role::CheckBox, "Ghost in MuJoCo").click();
    harness.run_steps(2);
    harness.state_mut().tick();
    assert_eq!(ghost(&harness), Some(GhostKind::Engine(Engine::Mujoco)));
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
fn one_character_is_singular_and_two_are_plural() {
    let mut harness = open(PanelKind::Physics);
    harness.run_steps(2);
    assert!(harness.query_by_role_and_label(Role::Slider, "character").is_some());
    assert!(harness.query_by_role_and_label(Role::Slider, "characters").is_none());
    harness.state_mut().apply(ViewerCommand::Characters(2));
    harness.run_steps(2);
    assert!(harness.query_by_role_and_label(Role::Slider, "characters").is_some());
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
