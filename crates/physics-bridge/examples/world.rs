//! A shared world: two characters walk at each other, past a crate, while a ball is thrown at one of them.
//!
//! `cargo run --release -p physics-bridge --example world`

use std::sync::Arc;

use physics_bridge::{Model, Motion, Part, Prop, World};
use policy_core::glam::{Vec2, Vec3};
use policy_core::{CharacterPack, Command, Controller, Goal, Heading};

const ASSETS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets");

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let pack = CharacterPack::from_bytes(&std::fs::read(format!("{ASSETS}/humanoid.pack.safetensors"))?)?;
    let model = Model::for_pack(&pack)?;
    let walk = Goal::Node(pack.graph().node_named("walk").ok_or("expected a node named walk")?);
    let pack = Arc::new(pack);

    // Everything that is added together is built together. Balls that are reserved can be thrown at any time.
    let ball = Prop::ball(0.11, 3.0);
    let mut world = World::new(&model)?;
    let (left, right, crate_) = world.edit(|edit| {
        let left = edit.add_character(&model, -3.0, 0.0, Heading::FORWARD, 1.2)?;
        let right = edit.add_character(&model, 3.0, 0.2, Heading::from_angle(std::f32::consts::PI), 1.2)?;
        let crate_ = edit.add_prop(Prop::cube(0.5, 8.0), Motion::at(Vec3::new(-1.5, 0.1, 0.25)))?;
        edit.reserve_props(&ball, 8)?;
        Ok((left, right, crate_))
    })?;

    let command = |x: f32| Command { target: Some(Vec2::new(x, 0.0)), goal: walk, ..Command::default() };
    let mut players = [
        (left, Controller::new(Arc::clone(&pack)), command(50.0)),
        (right, Controller::new(pack), command(-50.0)),
    ];
    let mut met = false;
    for tick in 0..180 {
        if tick == 45 {
            let throw = Motion::at(Vec3::new(0.0, 4.0, 1.2)).moving(Vec3::new(3.0, -8.0, 2.0));
            world.edit(|edit| edit.add_prop(ball.clone(), throw))?;
        }
        world.control_tick(&mut players, 1.0 / model.control_hz());
        for divergence in world.divergences() {
            println!("{divergence:?}");
        }
        met |= world
            .contacts()
            .iter()
            .any(|contact| matches!(contact.parts, [Part::Body(a, _), Part::Body(b, _)] if a != b));
        if tick % 15 == 14 {
            let secs = (tick + 1) as f32 / model.control_hz();
            let [a, b] = [left, right].map(|character| world.sensed(character).map(|s| s.root().position.x));
            let (a, b, crate_) = (a?, b?, world.motion(crate_)?.position.x);
            let met = if std::mem::take(&mut met) { ", they touch" } else { "" };
            println!("{secs:4.1} s  left {a:5.2} m, right {b:5.2} m, crate {crate_:5.2} m{met}");
        }
    }
    Ok(())
}
