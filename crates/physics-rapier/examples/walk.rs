//! A character of a pack walks in Rapier: load, then sense, decide, actuate and step in every control tick. Says how far
//! it got, and what a physics step cost.
//!
//! `cargo run --release -p physics-rapier --example walk -- [torques | motors] [NODE]`

use std::sync::Arc;
use std::time::{Duration, Instant};

use physics_rapier::{Character, Drive, Model, WALKING_START_MPS};
use policy_core::glam::Vec2;
use policy_core::{CharacterPack, Command, Controller, ControllerConfig, Goal, Heading};

const ASSETS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets");

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let drive = if words.iter().any(|word| word == "motors") { Drive::Motors } else { Drive::Torques };
    let pack = CharacterPack::from_bytes(&std::fs::read(format!("{ASSETS}/humanoid.pack.safetensors"))?)?;
    let model = Model::for_pack(&pack)?;
    let pack = Arc::new(pack);
    let node = words.iter().find_map(|word| pack.graph().node_named(word));
    let walk = node.or(pack.graph().node_named("walk")).ok_or("expected a node walk")?;
    let config = ControllerConfig { start: walk, auto_recover: false, ..ControllerConfig::default() };
    let mut controller = Controller::with_config(pack, config);

    let mut character = Character::with_drive(&model, drive);
    character.stand_at(0.0, 0.0, Heading::FORWARD, WALKING_START_MPS)?;
    let dt_secs = 1.0 / model.control_hz();
    let (mut fallen_ticks, mut least) = (0, Duration::MAX);
    let start = Instant::now();
    for _ in 0..(10.0 / dt_secs) as u32 {
        let place = character.sensed().root().position.truncate();
        let target = Some(place + Vec2::new(5.0, 0.0));
        let command = Command { target, goal: Goal::Node(walk), ..Command::default() };
        let tick = Instant::now();
        character.control_tick(&mut controller, &command, dt_secs)?;
        least = least.min(tick.elapsed());
        fallen_ticks += u32::from(controller.report().fallen);
    }
    let mean = start.elapsed() / character.tick() as u32;
    println!(
        "in 10 s it went {:.2} m ahead, on the ground in {fallen_ticks} ticks",
        character.centre_of_mass().x
    );
    println!("{drive:?}: a control tick takes {mean:?} in the mean, {least:?} at least");
    Ok(())
}
