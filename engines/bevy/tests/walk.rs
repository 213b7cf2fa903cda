//! Characters walk at any fixed rate.

mod common;

use bevy::prelude::*;
use common::{game, heard, place, report, run, spawn, walk_to};

/// Walks for 20 s at a fixed rate. Returns metres made along z, and control ticks.
fn walk(hz: f64) -> (f32, u64) {
    let mut app = game(hz);
    let character = spawn(&mut app, Vec3::ZERO);
    app.world_mut().entity_mut(character).insert(walk_to(Vec3::new(0.0, 0.0, -100.0)));
    run(&mut app, 20.0);
    let heard = heard(&app);
    assert!(heard.errors.is_empty(), "{:?}", heard.errors);
    assert_eq!(heard.fell, 0, "it fell");
    (-place(&app, character).z, report(&app, character).ticks)
}

#[test]
fn it_walks_ten_metres_at_bevys_rate() {
    let (metres, ticks) = walk(64.0);
    println!("{metres} m at 64 Hz");
    assert!(metres > 10.0, "{metres} m");
    assert!((595..=605).contains(&ticks), "{ticks} ticks in 20 s");
}

#[test]
fn it_walks_ten_metres_at_60_hz() {
    let (metres, ticks) = walk(60.0);
    println!("{metres} m at 60 Hz");
    assert!(metres > 10.0, "{metres} m");
    assert!((595..=605).contains(&ticks), "{ticks} ticks in 20 s");
}

#[test]
fn it_walks_ten_metres_at_144_hz() {
    let (metres, ticks) = walk(144.0);
    println!("{metres} m at 144 Hz");
    assert!(metres > 10.0, "{metres} m");
    assert!((595..=605).contains(&ticks), "{ticks} ticks in 20 s");
}
