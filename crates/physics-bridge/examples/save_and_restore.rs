//! Save and restore: a body and its controller together are the whole state. Restored, they repeat every bit.
//!
//! `cargo run --release -p physics-bridge --example save_and_restore`

use std::sync::Arc;

use physics_bridge::{Character, Model};
use policy_core::glam::{Vec2, Vec3};
use policy_core::{CharacterPack, Command, Controller, ControllerState, Goal};

const ASSETS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets");

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let pack =
        Arc::new(CharacterPack::from_bytes(&std::fs::read(format!("{ASSETS}/humanoid.pack.safetensors"))?)?);
    let model = Model::for_pack(&pack)?;
    let goal = Goal::Node(pack.graph().node_named("walk").ok_or("expected a node named walk")?);
    let torso = model.skeleton().body_named("torso").ok_or("expected a body named torso")?;
    let command = Command { target: Some(Vec2::new(30.0, 0.0)), goal, ..Command::default() };

    let mut character = Character::new(&model);
    let mut controller = Controller::new(pack.clone());
    // Both buffers are made once; saving into them does not allocate.
    let mut body = character.save();
    let mut mind = ControllerState::new(&pack);

    let mut ends = Vec::new();
    for tick in 0..120 {
        if tick == 60 {
            character.push(torso, Vec3::Y * 150.0, 0.2)?;
            character.save_into(&mut body);
            controller.save_into(&mut mind);
        }
        character.control_tick(&mut controller, &command, 1.0 / model.control_hz())?;
    }
    ends.push(character.save().hash());

    character.restore(&body)?;
    controller.restore(&mind)?;
    for _ in 60..120 {
        character.control_tick(&mut controller, &command, 1.0 / model.control_hz())?;
    }
    ends.push(character.save().hash());

    println!("after two seconds: {:016x}, and again: {:016x}", ends[0], ends[1]);
    assert_eq!(ends[0], ends[1], "expected the same bits");
    Ok(())
}
