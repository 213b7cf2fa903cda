//! A crowd of 100: one call senses, evaluates all policies as a batch, and steps on every core.
//!
//! `cargo run --release -p physics-bridge --example crowd`

use std::sync::Arc;
use std::time::Instant;

use physics_bridge::{Character, Crowd, Model};
use policy_core::glam::Vec2;
use policy_core::{CharacterPack, Command, Controller, Goal, Heading};

const ASSETS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets");
const COUNT: usize = 100;
const TICKS: u32 = 150;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let pack =
        Arc::new(CharacterPack::from_bytes(&std::fs::read(format!("{ASSETS}/humanoid.pack.safetensors"))?)?);
    let model = Model::for_pack(&pack)?;
    let speed = pack.graph().path_named("speed").ok_or("expected a path named speed")?;

    let mut characters = Vec::new();
    let mut commands = Vec::new();
    for index in 0..COUNT {
        let (x, y) = (2.0 * (index / 10) as f32, 2.0 * (index % 10) as f32);
        let mut character = Character::new(&model);
        character.stand_at(x, y, Heading::FORWARD, 0.0)?;
        characters.push(character);
        commands.push(Command {
            target: Some(Vec2::new(x + 100.0, y)),
            goal: Goal::Path { path: speed, coordinate: 3.0 * index as f32 / COUNT as f32 },
            ..Command::default()
        });
    }
    let mut crowd = Crowd::new(characters, None)?;
    let mut controllers = vec![Controller::new(pack); COUNT];

    let start = Instant::now();
    let mut controlling = 0.0;
    for _ in 0..TICKS {
        let diverged = crowd.control_tick(&mut controllers, &commands, 1.0 / model.control_hz());
        assert_eq!(diverged, 0, "expected plausible motion");
        controlling += crowd.control_time().as_secs_f64();
    }
    let secs = start.elapsed().as_secs_f64();
    let realtime = f64::from(TICKS) / f64::from(model.control_hz()) / secs;
    let share = 100.0 * controlling / (secs * crowd.threads() as f64);
    println!("{COUNT} characters on {} threads: {realtime:.1} times real time", crowd.threads());
    println!("controllers and policies take {share:.1} % of it");
    Ok(())
}
