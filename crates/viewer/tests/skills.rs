//! The Skills panel over a pack that has skills: a made one, from the policies that ship. Driven by label.

mod common;

use std::sync::Arc;

use common::{SCORE, pack_with_skills, simulation_of};
use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use physics::PhysicsCharacter as _;
use policy_core::{SkillEnd, SkillId};
use viewer::app::{App, PanelKind, Side};

fn harness(threshold: f32) -> Harness<'static, App> {
    let layout = common::advanced(vec![(PanelKind::Skills, Side::Left)]);
    let app = App::new(simulation_of(Arc::new(pack_with_skills(threshold))), layout);
    let mut harness = Harness::builder()
        .with_size(egui::vec2(900.0, 700.0))
        .build_ui_state(|ui, app: &mut App| app.ui(ui), app);
    harness.run_steps(2);
    harness
}

/// One tick of the world, then a frame that shows it.
fn tick(harness: &mut Harness<'_, App>) {
    assert!(harness.state_mut().tick().is_empty());
    harness.run_steps(1);
}

/// Ticks until `reached`, for two seconds at most.
fn until(harness: &mut Harness<'_, App>, reached: impl Fn(&App) -> bool) {
    for _ in 0..60 {
        tick(harness);
        if reached(harness.state()) {
            return;
        }
    }
    panic!("not reached within two seconds: {:?}", harness.state().sim.player().report());
}

fn start_hop(harness: &mut Harness<'_, App>) {
    harness.get_by_role_and_label(Role::Button, "hop").click();
    harness.run_steps(2);
    tick(harness);
    // It starts from walking alone: until then its button says that it waits.
    assert!(harness.query_by_role_and_label(Role::Button, "hop ...").is_some());
    until(harness, |app| app.sim.player().report().skill.is_some());
    assert!(harness.query_by_role_and_label(Role::Button, "hop ...").is_none());
    assert!(harness.query_by_role(Role::ProgressIndicator).is_some());
}

#[test]
fn a_skill_waits_runs_shows_its_score_and_is_recognised() {
    let mut harness = harness(0.7);
    assert!(harness.query_by_label("This pack has no episodic skills.").is_none());
    assert!(harness.query_by_role(Role::ProgressIndicator).is_none());
    start_hop(&mut harness);
    assert!(harness.query_by_label("not enough motion seen yet, held 0.00 of 0.17 s").is_some());
    until(&mut harness, |app| app.sim.player().report().skill.is_some_and(|s| s.held_seconds > 0.09));
    assert!(harness.query_by_label("score 0.75, held 0.10 of 0.17 s").is_some());
    assert!(harness.query_by_label_contains("hop 0.").is_some(), "the bar says how long it runs");
    assert!((harness.state().plots.score.last().unwrap() - SCORE).abs() < 1e-4);
    until(&mut harness, |app| app.sim.player().report().skill.is_none());
    let report = *harness.state().sim.player().report();
    assert_eq!(report.skill_ended, Some((SkillId::new(0), SkillEnd::Recognised)));
    let idle = harness.state().sim.pack().graph().node_named("idle");
    assert_eq!(report.position.as_node(), idle);
    assert!(harness.query_by_role(Role::ProgressIndicator).is_none());
    assert!(harness.query_by_role_and_label(Role::Button, "hop").is_some());
}

#[test]
fn a_skill_that_is_not_recognised_ends_by_time() {
    let mut harness = harness(0.9);
    start_hop(&mut harness);
    until(&mut harness, |app| app.sim.player().report().skill.is_some_and(|s| s.score.is_some()));
    assert!(harness.query_by_label("score 0.75, held 0.00 of 0.17 s").is_some());
    until(&mut harness, |app| app.sim.player().report().skill_ended.is_some());
    assert_eq!(
        harness.state().sim.player().report().skill_ended,
        Some((SkillId::new(0), SkillEnd::TimeLimit))
    );
}

#[test]
fn who_lies_starts_the_recovery_and_the_panel_says_so() {
    let mut harness = harness(0.7);
    let sim = &mut harness.state_mut().sim;
    let physics_bridge::Pose { mut qpos, mut qvel } = sim.character(0).pose();
    qvel.fill(0.0);
    // On its back.
    qpos[2] = 0.15;
    let half = std::f64::consts::FRAC_1_SQRT_2;
    qpos[3..7].copy_from_slice(&[half, 0.0, -half, 0.0]);
    sim.character_mut(0).set_pose(&qpos, &qvel).unwrap();
    until(&mut harness, |app| app.sim.player().report().skill.is_some());
    let report = *harness.state().sim.player().report();
    assert_eq!(
        (report.skill.map(|s| s.skill), report.skill_started),
        (Some(SkillId::new(1)), Some(SkillId::new(1)))
    );
    assert!(harness.query_by_label("ends by time").is_some());
    assert!(harness.query_by_label_contains("rise 0.").is_some());
    assert!(harness.state().sim.player().is_down());
    until(&mut harness, |app| app.sim.player().report().skill_ended.is_some());
    assert_eq!(
        harness.state().sim.player().report().skill_ended,
        Some((SkillId::new(1), SkillEnd::TimeLimit))
    );
    // Who can try to rise by itself is not stood up.
    assert_eq!(harness.state().sim.totals().stood_up, 0);
}
