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
    let told = app.toasts.take_text().unwrap();
    assert_eq!(told.matches("second player").count(), 1, "{told}");
    // A message that is shown is not shown twice: once it is read, it does not come again.
    (0..3).for_each(|_| drop(app.tick()));
    assert_eq!(app.toasts.take_text(), None);
}

#[test]
fn the_camera_sees_both_players() {
    let mut app = App::new(playground(2), PanelLayout::default());
    app.pad.second = Some(REST);
    for _ in 0..60 {
        drop(app.tick());
        app.follow(app.sim.tick_secs(), 1.0);
    }
    let view = app.camera.view();
    let clip = view.clip_from_world(16.0 / 9.0);
    for index in [0, SECOND_CHARACTER] {
        let seen = clip.project_point3(app.sim.poses(index, 1.0).positions[0]);
        let ahead = 0.0 < seen.z && seen.z < 1.0;
        assert!(ahead && seen.x.abs() < 1.0 && seen.y.abs() < 1.0, "character {index} at {seen}");
    }
}

#[test]
fn the_camera_looks_through_both_players_and_no_other_character() {
    let mut sim = playground(3);
    run(&mut sim, &REST, 1);
    let head = |sim: &Simulation, index: usize| sim.poses(index, 1.0).positions[1];
    let [first, second, third] = [0, 1, 2].map(|index| head(&sim, index));
    let mut hit = |at: glam::Vec3, players: usize| {
        // From above, where nothing else is.
        let from = at + glam::Vec3::Z * 2.0;
        sim.shared_mut().unwrap().hidden_at(from, glam::Vec3::NEG_Z, 2.1, players)
    };
    assert_eq!((hit(first, 1), hit(second, 2)), (None, None));
    assert!(hit(second, 1).is_some() && hit(third, 2).is_some());
}

#[test]
fn a_tap_of_a_pad_between_two_ticks_counts_once() {
    let mut app = App::new(playground(1), PanelLayout::default());
    app.clock.speed = 1.0 / 32.0;
    let balls = |app: &App| app.sim.shared().unwrap().pieces().len();
    let before = balls(&app);
    for pressed in [false, true, false] {
        app.pad.state.buttons.set(THROW_BUTTON, pressed);
        app.advance(0.02);
    }
    assert_eq!((app.sim.ticks(), balls(&app)), (0, before), "no tick was due");
    (0..4).for_each(|_| drop(app.tick()));
    assert_eq!(balls(&app), before + 1);
}
