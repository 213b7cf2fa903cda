//! A skinned mesh of a glTF follows the character: its bones are called as the bodies.
//!
//! `cargo run --release --features window --example own_mesh`

mod scene;

use bevy::prelude::*;
use bevy_policy_space::prelude::*;

fn main() {
    let mut app = App::new();
    app.add_plugins((scene::window(), PolicySpacePlugins, scene::scene))
        .add_systems(Startup, spawn)
        .add_systems(Update, never_cull)
        .run();
}

fn spawn(mut commands: Commands, assets: Res<AssetServer>) {
    let character = commands
        .spawn((
            PolicyCharacter::new(assets.load(scene::PACK)),
            CharacterCommand::along("speed", 1.5, Vec3::new(0.0, 0.0, -100.0)),
            scene::Followed,
        ))
        .id();
    let mesh = assets.load(GltfAssetLabel::Scene(0).from_asset("humanoid.glb"));
    // A bone with another name than its body: `renamed: vec![("pelvis".into(), "Hips".into())]`.
    commands.spawn((WorldAssetRoot(mesh), PolicySkin::of(character)));
}

/// Plain Bevy: the box that a skinned mesh is culled by does not move with its bones.
fn never_cull(
    mut commands: Commands,
    meshes: Query<Entity, (Added<Mesh3d>, With<bevy::mesh::skinning::SkinnedMesh>)>,
) {
    for mesh in &meshes {
        commands.entity(mesh).insert(bevy::camera::visibility::NoFrustumCulling);
    }
}
