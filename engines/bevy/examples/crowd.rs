//! Twenty characters, each to a point of its own, at speeds of their own.
//!
//! `cargo run --release --features window --example crowd`

mod scene;

use bevy::prelude::*;
use bevy_policy_space::BodyMeshes;
use bevy_policy_space::prelude::*;

const COUNT: usize = 20;

fn main() {
    let mut app = App::new();
    app.add_plugins((scene::window(), PolicySpacePlugins, scene::scene))
        .add_systems(Startup, spawn)
        .add_systems(Update, wander)
        .run();
}

fn spawn(mut commands: Commands, assets: Res<AssetServer>) {
    // One handle: all characters share one pack.
    let pack = assets.load(scene::PACK);
    for index in 0..COUNT {
        let (row, column) = ((index / 5) as f32, (index % 5) as f32);
        let place = Vec3::new(2.5 * (column - 2.0), 0.0, -2.5 * row);
        let color = Color::hsl(360.0 * index as f32 / COUNT as f32, 0.5, 0.6);
        let mut character = commands.spawn((
            PolicyCharacter::new(pack.clone()),
            CharacterCommand::along("speed", 1.0, place),
            BodyMeshes { color },
            Transform::from_translation(place),
        ));
        if index == 2 {
            character.insert(scene::Followed);
        }
    }
}

/// Whoever is near its target gets the next one, on a circle.
fn wander(mut characters: Query<(Entity, &Transform, &mut CharacterCommand)>, mut turns: Local<u32>) {
    for (entity, place, mut command) in &mut characters {
        let near = command.target.is_none_or(|target| target.distance(place.translation) < 1.0);
        if near {
            *turns += 1;
            let angle = 2.4 * (*turns as f32 + entity.index_u32() as f32);
            let radius = 4.0 + (*turns % 7) as f32;
            let target = Vec3::new(radius * angle.cos(), 0.0, radius * angle.sin());
            let speed = 1.0 + 0.25 * (*turns % 5) as f32;
            *command = CharacterCommand::along("speed", speed, target);
        }
    }
}
