//! Keys that are held, tapped or being assigned.

mod common;

use common::harness::harness;
use common::{playground, simulation};
use egui_kittest::Harness;
use policy_core::Button;
use viewer::app::{App, KeyAction, PanelLayout};

fn shown(app: App) -> Harness<'static, App> {
    let mut harness = harness(app);
    harness.run_steps(2);
    harness
}

/// A key that is held for so long that it repeats twice.
fn hold(harness: &mut Harness<'_, App>, key: egui::Key) {
    for _ in 0..3 {
        harness.key_down(key);
        harness.run_steps(1);
    }
    harness.key_up(key);
    harness.run_steps(1);
}

#[test]
fn a_held_key_acts_once_and_ticks_and_speeds_repeat() {
    let mut harness = shown(App::new(playground(1), PanelLayout::default()));
    hold(&mut harness, egui::Key::P);
    assert!(harness.state().clock.paused);
    hold(&mut harness, egui::Key::P);
    assert!(!harness.state().clock.paused);
    hold(&mut harness, egui::Key::C);
    let camera = harness.state().camera.mode;
    let mut once = shown(App::new(simulation(), PanelLayout::default()));
    once.key_press(egui::Key::C);
    once.run_steps(1);
    assert_eq!(camera, once.state().camera.mode);
    let props = |harness: &Harness<'_, App>| harness.state().sim.shared().unwrap().pieces().len();
    let before = props(&harness);
    hold(&mut harness, egui::Key::T);
    assert_eq!(props(&harness), before + 1);
    hold(&mut harness, egui::Key::Minus);
    assert_eq!(harness.state().clock.speed, 0.125);
    hold(&mut harness, egui::Key::N);
    assert_eq!(harness.state().clock.steps, 3);
}

#[test]
fn a_tap_in_slow_motion_reaches_the_next_tick_and_no_other() {
    let mut harness = shown(App::new(simulation(), PanelLayout::default()));
    harness.state_mut().clock.speed = 1.0 / 32.0;
    harness.key_press(egui::Key::R);
    harness.run_steps(1);
    let pressed = |harness: &Harness<'_, App>| harness.state().input().buttons.contains(Button::East);
    for _ in 0..4 {
        harness.state_mut().advance(0.2);
        harness.run_steps(1);
        assert!(pressed(&harness), "no tick was due");
    }
    harness.state_mut().advance(0.25);
    harness.state_mut().advance(0.25);
    harness.run_steps(1);
    assert!(harness.state().sim.ticks() == 1 && !pressed(&harness));
}

#[test]
fn a_key_that_is_being_assigned_does_nothing_else() {
    let mut harness = shown(App::new(playground(1), PanelLayout::default()));
    harness.key_down(egui::Key::W);
    harness.run_steps(1);
    harness.state_mut().advance(0.01);
    assert!(harness.state().input().left_stick[1] > 0.0);
    harness.state_mut().rebinding = Some(KeyAction::Jump);
    harness.run_steps(1);
    harness.state_mut().advance(0.25);
    assert_eq!(harness.state().input().left_stick, [0.0; 2], "the stick goes back");
    let props = |harness: &Harness<'_, App>| harness.state().sim.shared().unwrap().pieces().len();
    let before = props(&harness);
    harness.key_press(egui::Key::T);
    harness.run_steps(1);
    assert_eq!(props(&harness), before, "T is refused, and throws nothing");
    assert!(harness.state().toasts.iter().any(|toast| toast.text == "T is already used."));
}
