//! The pack is loaded again whenever its file changes, under the feet of the running character.
//!
//! `cargo run --release --features window --example hot_reload`, then copy another pack of the same body over
//! `target/hot_reload/hero.pack.safetensors`. A file that is no pack changes nothing but prints an error.

mod scene;

use bevy::prelude::*;
use bevy_policy_space::BodyMeshes;
use bevy_policy_space::prelude::*;

const ASSETS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets");
const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/target/hot_reload");

fn main() -> std::io::Result<()> {
    std::fs::create_dir_all(FOLDER)?;
    std::fs::copy(format!("{ASSETS}/{}", scene::PACK), format!("{FOLDER}/hero.pack.safetensors"))?;
    let files = AssetPlugin { file_path: FOLDER.into(), watch_for_changes_override: Some(true), ..default() };
    let mut app = App::new();
    app.add_plugins((DefaultPlugins.set(files), PolicySpacePlugins, scene::scene))
        .add_systems(Startup, spawn)
        .add_systems(Update, tell)
        .run();
    Ok(())
}

fn spawn(mut commands: Commands, assets: Res<AssetServer>) {
    commands.spawn((
        PolicyCharacter::new(assets.load("hero.pack.safetensors")),
        CharacterCommand::along("speed", 1.0, Vec3::new(0.0, 0.0, -1000.0)),
        BodyMeshes::default(),
        scene::Followed,
    ));
}

fn tell(mut events: MessageReader<AssetEvent<PackAsset>>) {
    for event in events.read() {
        if let AssetEvent::Modified { .. } = event {
            info!("the pack was loaded again");
        }
    }
}
