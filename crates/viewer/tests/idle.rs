//! When the tour begins by itself, how that is told, and what ends it.

mod common;

use common::harness::harness;
use common::simulation;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use playground::RaceState;
use policy_core::{Goal, NodeId};
use viewer::app::{App, Grab, IDLE_SECS, PanelLayout};
use viewer::sim::Held;

fn app() -> App {
    App::new(simulation(), PanelLayout::default())
}

/// Lets so many seconds pass, in slow motion.
fn wait(app: &mut App, secs: f32) {
    app.clock.speed = 1.0 / 32.0;
    (0..(secs * 4.0) as usize).for_each(|_| app.advance(0.25));
}

fn moved_to(harness: &mut Harness<'_, App>, x: f32) {
    harness.event(egui::Event::PointerMoved(egui::pos2(x, 300.0)));
    harness.run_steps(1);
}

#[test]
fn a_mouse_that_jitters_or_enters_does_not_end_the_tour_and_one_that_moves_does() {
    let mut harness = harness(app());
    harness.run_steps(2);
    harness.state_mut().tour.start();
    harness.event(egui::Event::WindowFocused(true));
    for x in [400.0, 401.0, 399.0, 402.0] {
        moved_to(&mut harness, x);
    }
    // Out of the window and into it elsewhere.
    harness.event(egui::Event::PointerGone);
    moved_to(&mut harness, 100.0);
    let event = |pressed| egui::Event::Key {
        key: egui::Key::A,
        physical_key: None,
        pressed,
        repeat: false,
        modifiers: egui::Modifiers::NONE,
    };
    harness.event(event(false));
    harness.run_steps(1);
    assert!(harness.state().tour.is_playing());
    moved_to(&mut harness, 104.0);
    assert!(!harness.state().tour.is_playing());
}

#[test]
fn the_tour_is_announced_and_told_in_a_layout_without_panels() {
    let mut harness = harness(app());
    harness.state_mut().layout.hidden = true;
    harness.run_steps(2);
    wait(harness.state_mut(), IDLE_SECS - 5.0);
    harness.run_steps(2);
    assert!(harness.query_by_label_contains("The tour starts in 5 s").is_some());
    wait(harness.state_mut(), 6.0);
    harness.run_steps(2);
    assert!(harness.query_by_label_contains("Tour: press any key").is_some());
}

#[test]
fn the_tour_does_not_begin_while_the_player_is_in_the_middle_of_something() {
    let busy: [fn(&mut App); 4] = [
        |app| app.layout.preferences.advanced = true,
        |app| app.sim.overrides.goal = Some(Goal::Node(NodeId::new(1))),
        |app| app.layers.active = true,
        |app| {
            let root = app.sim.pack().skeleton().root();
            app.grab = Some(Grab { held: Held::Body(0, root), pull: glam::Vec3::ZERO });
        },
    ];
    for (index, make_busy) in busy.into_iter().enumerate() {
        let mut app = app();
        make_busy(&mut app);
        wait(&mut app, IDLE_SECS + 2.0);
        assert!(!app.tour.is_playing(), "{index}");
        // One that was asked for on the command line plays.
        app.tour.start();
        wait(&mut app, 1.0);
        assert!(app.tour.is_playing(), "{index}");
    }
}

#[test]
fn a_run_over_the_course_that_the_tour_began_ends_with_it() {
    let mut harness = harness(App::new(common::playground(1), PanelLayout::default()));
    harness.run_steps(2);
    harness.state_mut().tour.start();
    let state = |harness: &Harness<'_, App>| harness.state().sim.shared().unwrap().race().state();
    for _ in 0..90 {
        drop(harness.state_mut().tick());
    }
    assert_eq!(state(&harness), RaceState::Running);
    harness.key_press(egui::Key::A);
    harness.run_steps(2);
    assert_eq!(state(&harness), RaceState::Waiting);
}
