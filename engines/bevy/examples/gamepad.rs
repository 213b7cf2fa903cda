//! A player steers a character with a gamepad, or with the keys that `PolicyInputPlugin` names.
//!
//! `cargo run --release --features window,pads --example gamepad`

mod scene;

use bevy::prelude::*;
use bevy_policy_space::prelude::*;
use bevy_policy_space::{BodyMeshes, PolicyGizmos};

fn main() {
    let mut app = App::new();
    app.add_plugins((scene::window(), PolicySpacePlugins, scene::scene))
        .add_systems(Startup, spawn)
        .add_systems(Update, (look_through_camera, toggle_gizmos))
        .run();
}

fn spawn(mut commands: Commands, assets: Res<AssetServer>) {
    commands.spawn((
        PolicyCharacter::new(assets.load(scene::PACK)),
        PlayerInput::default(),
        BodyMeshes::default(),
        scene::Followed,
    ));
}

/// Ahead is where the camera looks.
fn look_through_camera(mut players: Query<&mut PlayerInput>, cameras: Query<Entity, Added<Camera3d>>) {
    for camera in &cameras {
        for mut player in &mut players {
            player.camera = Some(camera);
        }
    }
}

/// Key 1 shows what the plug-in thinks.
fn toggle_gizmos(keys: Res<ButtonInput<KeyCode>>, mut gizmos: ResMut<PolicyGizmos>) {
    if keys.just_pressed(KeyCode::Digit1) {
        *gizmos = PolicyGizmos::all(!gizmos.skeleton);
    }
}
