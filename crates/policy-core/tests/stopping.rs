//! Stops: while a character comes to a stand its gaits give all of their weight to their stopping variant.

mod common;

use std::sync::Arc;

use common::{hand_over, moving, weight_of};
use glam::{Vec2, Vec3};
use policy_core::{CharacterPack, Command, Controller, ControllerConfig, GiveWay, Goal, PathId};

const DT: f32 = 1.0 / 30.0;

/// The stopping variant in the made-up pack.
const STOPS: &str = "roll";

/// It stands at `idle`, walks at 1 m/s, jogs at 2 m/s and crouches at 0.4 m/s; a crouch has no stopping variant.
fn pack() -> Arc<CharacterPack> {
    let manifest = common::gaits(|gait| gait.stopping = Some(STOPS.into()));
    Arc::new(CharacterPack::from_parts(manifest, common::tensors(0.0)).unwrap())
}

fn controller(give_way: Option<GiveWay>) -> Controller {
    Controller::with_config(pack(), ControllerConfig { give_way, ..ControllerConfig::default() })
}

/// A controller of a character that has gone at a speed along a path for two seconds.
fn goes(path: usize, coordinate: f32, speed: f32) -> Controller {
    let mut controller = controller(None);
    (0..60).for_each(|_| assert_eq!(share(&mut controller, speed, path, Some(coordinate)), 0.0));
    controller
}

/// One tick at a speed ahead; asked to go on to a coordinate of a path, or to stand. Returns the share of the stopping variant.
fn share(controller: &mut Controller, speed: f32, path: usize, coordinate: Option<f32>) -> f32 {
    let goal = Goal::Path { path: PathId::new(path), coordinate: coordinate.unwrap_or_default() };
    let command = Command { goal, target: coordinate.map(|_| Vec2::X * 10.0), ..Command::default() };
    controller.tick(&moving(Vec3::X * speed), &command, DT);
    weight_of(controller, STOPS)
}

#[test]
fn it_takes_all_in_the_tick_in_which_the_stick_is_released() {
    for (coordinate, speed) in [(1.0, 1.0), (2.0, 2.0), (1.5, 1.4)] {
        let mut controller = goes(0, coordinate, speed);
        for slower in [1.0, 0.9, 0.6, 0.4] {
            assert_eq!(share(&mut controller, slower * speed, 0, None), 1.0, "from {coordinate}");
        }
        let back: Vec<f32> = (0..7).map(|_| share(&mut controller, speed, 0, Some(coordinate))).collect();
        assert!(back[0] < 1.0 && back[6] == 0.0, "it goes on: {back:?}");
    }
}

#[test]
fn a_stop_ends_by_itself_and_leaves_the_stand_to_the_others() {
    for (speed, most) in [(0.2, 3), (0.5, 60)] {
        let mut controller = goes(0, 1.0, 1.0);
        let ticks = (0..120).take_while(|_| share(&mut controller, speed, 0, None) == 1.0).count();
        assert!((most - 1..=most + 1).contains(&ticks), "at {speed} m/s: {ticks} ticks");
        assert_eq!((0..7).map(|_| share(&mut controller, speed, 0, None)).last(), Some(0.0));
        (0..30).for_each(|_| assert_eq!(share(&mut controller, 1.0, 0, None), 0.0, "pushed while it stands"));
    }
}

#[test]
fn what_hardly_moves_what_rests_in_a_low_gait_and_what_is_held_up_has_none() {
    assert_eq!(share(&mut goes(0, 1.0, 0.3), 0.3, 0, None), 0.0, "it has hardly set off");
    let mut low = goes(1, 2.0, 1.0);
    assert_eq!(share(&mut low, 1.0, 1, None), 0.0, "it leaves a crouch");
    let mut held_up = controller(Some(GiveWay { stop_secs: 1.0, ..GiveWay::default() }));
    (0..60).for_each(|_| _ = share(&mut held_up, 1.0, 0, Some(1.0)));
    let shares: Vec<f32> = (0..60).map(|_| share(&mut held_up, 0.2, 0, Some(1.0))).collect();
    assert!(shares.iter().all(|share| *share == 0.0), "{shares:?}");
}

#[test]
fn a_saved_state_goes_on_with_its_stop() {
    let mut controller = goes(0, 2.0, 2.0);
    share(&mut controller, 2.0, 0, None);
    let mut other = goes(0, 1.0, 1.0);
    hand_over(&controller, &mut other);
    for tick in 0..70 {
        let shares = [&mut controller, &mut other].map(|c| share(c, 0.5, 0, None));
        assert_eq!(shares[0], shares[1], "tick {tick}");
        assert_eq!(controller.report(), other.report());
    }
}
