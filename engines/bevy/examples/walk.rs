//! A character walks to a point, and to another one once it is there.
//!
//! `cargo run --release --features window --example walk`

mod scene;

use bevy::prelude::*;
use bevy_policy_space::BodyMeshes;
use bevy_policy_space::prelude::*;

fn main() {
    let mut app = App::new();
    app.add_plugins((scene::window(), PolicySpacePlugins, scene::scene))
        .add_systems(Startup, spawn)
        .add_systems(Update, (choose_target, print_messages))
        .run();
}

fn spawn(mut commands: Commands, assets: Res<AssetServer>) {
    commands.spawn((
        PolicyCharacter::new(assets.load(scene::PACK)),
        CharacterCommand::along("speed", 1.0, Vec3::new(0.0, 0.0, -8.0)),
        BodyMeshes::default(),
        scene::Followed,
    ));
}

/// Two points, taken in turn.
fn choose_target(mut characters: Query<(&Transform, &mut CharacterCommand)>) {
    for (place, mut command) in &mut characters {
        let Some(target) = command.target else { continue };
        if place.translation.distance(target) < 1.0 {
            command.target = Some(-target);
        }
    }
}

fn print_messages(mut fell: MessageReader<Fell>, mut rose: MessageReader<Rose>) {
    for message in fell.read() {
        info!("{} fell", message.character);
    }
    for message in rose.read() {
        info!("{} is up again", message.character);
    }
}
