//! Two players in the playground, without a window.

mod common;

use common::{FORWARD, playground, simulation};
use policy_core::{GamepadState, Heading};
use viewer::app::{App, PanelLayout};
use viewer::sim::{SECOND_CHARACTER, Simulation, THROW_BUTTON};

const BACK: GamepadState = GamepadState { left_stick: [0.0, -1.0], ..FORWARD };
const REST: GamepadState = GamepadState { left_stick: [0.0; 2], ..FORWARD };

fn run(sim: &mut Simulation, pad: &GamepadState, ticks: usize) {
    (0..ticks).for_each(|_| drop(sim.tick(pad, Heading::FORWARD)));
}

#[test]
fn each_pad_steers_a_character_of_its_own() {
    let mut sim = playground(3);
    assert!(sim.set_second_pad(Some(&BACK)) && sim.has_second_player());
    run(&mut sim, &FORWARD, 1);
    let wanted = |sim: &Simulation, index: usize| {
        let character = &sim.characters()[index];
        (character.command.target.unwrap() - character.position()).normalize()
    };
    assert!(wanted(&sim, 0).x > 0.99, "{}", wanted(&sim, 0));
    assert!(wanted(&sim, SECOND_CHARACTER).x < -0.99, "{}", wanted(&sim, SECOND_CHARACTER));
    // At rest it stands, however much it would like to wander.
    assert!(sim.set_second_pad(Some(&REST)));
    for _ in 0..300 {
        run(&mut sim, &FORWARD, 1);
        assert_eq!(sim.characters()[SECOND_CHARACTER].command.target, None);
    }
    assert!(sim.set_second_pad(None) && !sim.has_second_player());
    let wanders = (0..300).any(|_| {
        run(&mut sim, &FORWARD, 1);
        sim.characters()[SECOND_CHARACTER].command.target.is_some()
    });
    assert!(wanders, "it wanders again");
}

#[test]
fn the_second_player_throws_from_where_it_is() {
    let mut sim = playground(2);
    let balls = |sim: &Simulation| sim.shared().unwrap().pieces().len();
    let (before, mut throws) = (balls(&sim), REST);
    throws.buttons.set(THROW_BUTTON, true);
    // A button that is held while it joins has not just been pressed.
    assert!(sim.set_second_pad(Some(&throws)));
    run(&mut sim, &REST, 1);
    assert_eq!(balls(&sim), before);
    assert!(sim.set_second_pad(Some(&REST)));
    run(&mut sim, &REST, 1);
    assert!(sim.set_second_pad(Some(&throws)));
    run(&mut sim, &REST, 2);
    assert_eq!(balls(&sim), before + 1);
    let ball = sim.shared().unwrap().pieces().last().unwrap().pose(1.0).0.truncate();
    let second = sim.characters()[SECOND_CHARACTER].position();
    assert!(ball.distance(second) < 2.0, "ball at {ball}, second player at {second}");
}

#[test]
fn without_a_character_for_it_a_second_player_is_told_so_once() {
    let mut app = App::new(simulation(), PanelLayout::default());
    app.pad.second = Some(FORWARD);
    (0..3).for_each(|_| drop(app.tick()));
    assert!(!app.sim.has_second_player());
    let told: Vec<_> = app.toasts.iter().filter(|toast| toast.text.contains("second player")).collect();
    assert_eq!(told.len(), 1, "{told:?}");
}

#[test]
fn the_camera_sees_both_players() {
    let mut app = App::new(playground(2), PanelLayout::default());
    app.pad.second = Some(REST);
    for _ in 0..60 {
        drop(app.tick());
        app.follow(app.sim.tick_secs(), 1.0);
    }
    let view = app.camera.view(0.0);
    let clip = view.clip_from_world(16.0 / 9.0);
    for index in [0, SECOND_CHARACTER] {
        let seen = clip.project_point3(app.sim.poses(index, 1.0).positions[0]);
        assert!(seen.x.abs() < 1.0 && seen.y.abs() < 1.0, "character {index} at {seen}");
    }
}
