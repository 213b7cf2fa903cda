//! Ramps, crates, a door that swings, and balls that are thrown at the character. All of it plain bevy_rapier.
//!
//! `cargo run --release --features window --example playground`, then W A S D and Enter for a ball.

mod scene;

use bevy::prelude::*;
use bevy_policy_space::prelude::*;
use bevy_policy_space::{BodyMeshes, PolicyGizmos};
use bevy_rapier3d::prelude::{ImpulseJoint, RevoluteJointBuilder, Velocity};

fn main() {
    let mut app = App::new();
    app.add_plugins((scene::window(), PolicySpacePlugins, scene::scene))
        .insert_resource(PolicyGizmos { target: true, contacts: true, ..PolicyGizmos::all(false) })
        .add_systems(Startup, (build, spawn))
        .add_systems(Update, throw)
        .run();
}

fn spawn(mut commands: Commands, assets: Res<AssetServer>) {
    commands.spawn((
        PolicyCharacter::new(assets.load(scene::PACK)),
        // With `PlayerInput::default()` in place of the command, the player steers.
        CharacterCommand::along("speed", 1.0, Vec3::new(0.0, 0.0, -30.0)),
        BodyMeshes::default(),
        scene::Followed,
    ));
}

fn build(mut commands: Commands, mut boxes: Boxes) {
    let wood = Color::srgb(0.55, 0.38, 0.22);
    for index in 0..9 {
        let place = Vec3::new((index % 3) as f32 * 0.5 - 0.5, 0.2 + 0.4 * (index / 3) as f32, -4.0);
        let part = boxes.part(Vec3::splat(0.4), wood, Transform::from_translation(place));
        commands.spawn((part, RigidBody::Dynamic));
    }
    for (x, slope) in [(-3.0, 0.12_f32), (3.0, 0.2)] {
        let place = Transform::from_xyz(x, 0.3, -5.0).with_rotation(Quat::from_rotation_x(slope));
        commands.spawn((
            boxes.part(Vec3::new(2.0, 0.1, 5.0), Color::srgb(0.4, 0.45, 0.6), place),
            RigidBody::Fixed,
        ));
    }
    let post = Transform::from_xyz(-0.6, 1.1, -2.0);
    let post = commands.spawn((boxes.part(Vec3::new(0.1, 2.2, 0.1), wood, post), RigidBody::Fixed)).id();
    let hinge = RevoluteJointBuilder::new(Vec3::Y).local_anchor1(Vec3::X * 0.1).local_anchor2(Vec3::X * -0.6);
    let door = boxes.part(Vec3::new(1.1, 2.0, 0.05), wood, Transform::from_xyz(0.1, 1.1, -2.0));
    commands.spawn((door, RigidBody::Dynamic, ImpulseJoint::new(post, hinge)));
}

/// A ball every three seconds, and with Enter.
fn throw(
    mut commands: Commands,
    mut boxes: Boxes,
    keys: Res<ButtonInput<KeyCode>>,
    time: Res<Time>,
    characters: Query<&Transform, With<PolicyCharacter>>,
) {
    let due = time.elapsed_secs() % 3.0 < time.delta_secs();
    let Ok(character) = characters.single() else { return };
    if due || keys.just_pressed(KeyCode::Enter) {
        let (from, to) =
            (character.translation + Vec3::new(3.0, 1.5, 3.0), character.translation + Vec3::Y * 1.2);
        let ball = boxes.ball(0.12, Color::srgb(0.8, 0.2, 0.2), Transform::from_translation(from));
        commands.spawn((ball, RigidBody::Dynamic, Velocity::linear((to - from).normalize() * 9.0)));
    }
}

use scene::Boxes;
