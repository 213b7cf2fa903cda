//! Walk in MuJoCo: a model, a character, a controller, and one call for each control tick.
//!
//! `cargo run --release -p physics-bridge --example walk_in_mujoco`

use std::sync::Arc;

use physics_bridge::{Character, Model};
use policy_core::glam::Vec2;
use policy_core::{CharacterPack, Command, Controller, Goal};

const ASSETS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets");

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let pack =
        Arc::new(CharacterPack::from_bytes(&std::fs::read(format!("{ASSETS}/humanoid.pack.safetensors"))?)?);
    let model = Model::for_pack(&pack)?;
    let speed = pack.graph().path_named("speed").ok_or("expected a path named speed")?;
    let mut character = Character::new(&model);
    let mut controller = Controller::new(pack);
    let dt_secs = 1.0 / model.control_hz();

    for tick in 0..(10.0 * model.control_hz()) as u32 {
        // Faster and faster along the path, towards a point far ahead on the left.
        let command = Command {
            target: Some(Vec2::new(50.0, 20.0)),
            goal: Goal::Path { path: speed, coordinate: 0.3 * tick as f32 * dt_secs },
            ..Command::default()
        };
        character.control_tick(&mut controller, &command, dt_secs)?;
        if tick % 30 == 29 {
            let (at, velocity) = (character.centre_of_mass(), character.centre_of_mass_velocity());
            let speed = velocity.truncate().length();
            println!(
                "{:4.1} s  at ({:5.2}, {:5.2}) m  {speed:4.2} m/s",
                (tick + 1) as f32 * dt_secs,
                at.x,
                at.y
            );
        }
    }
    Ok(())
}
