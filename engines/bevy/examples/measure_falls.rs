//! How often characters fall at a game's rate: they walk to and fro along a path and turn every two seconds.
//!
//! `cargo run --release --example measure_falls -- [HZ] [motors | torques] [PATH]`

use std::time::Duration;

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_policy_space::prelude::*;

const PACK: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/humanoid.pack.safetensors");
const CHARACTERS: usize = 12;
const SECS: f64 = 62.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let hz = words.iter().find_map(|word| word.parse().ok()).unwrap_or(64.0);
    let drive = if words.iter().any(|word| word == "torques") { Drive::Torques } else { Drive::Motors };
    let path = words.iter().find(|word| ["speed", "stance", "style"].contains(&word.as_str()));
    let path = path.map_or("speed", String::as_str).to_owned();

    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, AssetPlugin::default(), PolicySpacePlugins))
        .insert_resource(Time::<Fixed>::from_hz(hz))
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(1.0 / hz)));
    app.finish();
    app.cleanup();
    let world = app.world_mut();
    let floor = (Collider::cuboid(1000.0, 0.5, 1000.0), Friction::coefficient(1.0));
    world.spawn((floor, Transform::from_xyz(0.0, -0.5, 0.0)));
    let asset = PackAsset::from_bytes(&std::fs::read(PACK)?)?;
    let graph = asset.pack.graph();
    let end = graph.path(graph.path_named(&path).ok_or("expected a path of the pack")?).end();
    let pack = world.resource_mut::<Assets<PackAsset>>().add(asset);
    for index in 0..CHARACTERS {
        let place = Transform::from_xyz(30.0 * index as f32, 0.0, 0.0);
        let rapier = RapierCharacter { drive, ..default() };
        world.spawn((PolicyCharacter::new(pack.clone()), rapier, place));
    }

    let mut falls = 0;
    let mut cursor = world.resource::<Messages<Fell>>().get_cursor();
    for step in 0..(SECS * hz) as usize {
        let now = step as f64 / hz;
        let mut characters = app.world_mut().query::<(&Transform, &mut CharacterCommand)>();
        for (index, (place, mut command)) in characters.iter_mut(app.world_mut()).enumerate() {
            let turn = ((now / 2.0) as usize * 7 + index * 5) % 13;
            let angle = (turn as f32 / 12.0 - 0.5) * core::f32::consts::PI + (now / 2.0) as f32 * 0.1;
            let ahead = Vec3::new(angle.sin(), 0.0, -angle.cos());
            let sweep = 0.5 - 0.5 * (0.5 * now as f32 + index as f32).cos();
            *command = CharacterCommand::along(path.clone(), end * sweep, place.translation + 5.0 * ahead);
        }
        app.update();
        falls += cursor.read(app.world().resource::<Messages<Fell>>()).count();
    }
    let minutes = CHARACTERS as f64 * SECS / 60.0;
    println!(
        "{path} at {hz} Hz, {drive:?}: {falls} falls in {minutes:.1} minutes, {:.2} a minute",
        falls as f64 / minutes
    );
    Ok(())
}
