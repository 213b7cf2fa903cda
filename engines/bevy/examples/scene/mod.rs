//! What the examples share, all of it plain Bevy: a window, floor, light and a camera that follows a character.
#![allow(dead_code, reason = "not every example uses all of it")]

use bevy::prelude::*;
use bevy::render::view::screenshot::{Screenshot, save_to_disk};
use bevy_policy_space::prelude::*;

/// The pack in the folder of assets.
pub const PACK: &str = "humanoid.pack.safetensors";

/// A window, and the folder of assets of this repository.
pub fn window() -> impl PluginGroup {
    DefaultPlugins.set(AssetPlugin {
        file_path: concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets").into(),
        ..default()
    })
}

/// Floor, light and camera. With `POLICY_SPACE_PICTURE=FILE.png` it saves a picture after some seconds, logs the mean time of
/// a frame up to then, and exits.
pub fn scene(app: &mut App) {
    app.add_systems(Startup, build_scene).add_systems(PostUpdate, follow.before(TransformSystems::Propagate));
    if let Ok(file) = std::env::var("POLICY_SPACE_PICTURE") {
        app.insert_resource(Picture(file)).add_systems(Update, take_picture);
    }
}

/// The camera follows the character with this component.
#[derive(Component)]
pub struct Followed;

fn build_scene(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    commands.insert_resource(ClearColor(Color::srgb(0.60, 0.72, 0.85)));
    commands.spawn((
        Collider::cuboid(100.0, 0.5, 100.0),
        Friction::coefficient(1.0),
        Mesh3d(meshes.add(Cuboid::new(200.0, 1.0, 200.0))),
        MeshMaterial3d(materials.add(Color::srgb(0.35, 0.42, 0.38))),
        Transform::from_xyz(0.0, -0.5, 0.0),
    ));
    commands.spawn((
        DirectionalLight { shadow_maps_enabled: true, illuminance: 9000.0, ..default() },
        Transform::from_xyz(4.0, 9.0, 3.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
    commands.spawn((
        Camera3d::default(),
        AmbientLight { brightness: 400.0, ..default() },
        Transform::from_xyz(3.5, 2.2, 4.0).looking_at(Vec3::Y, Vec3::Y),
    ));
}

fn follow(
    followed: Query<&Transform, (With<Followed>, Without<Camera3d>)>,
    mut cameras: Query<&mut Transform, With<Camera3d>>,
) {
    let (Ok(character), Ok(mut camera)) = (followed.single(), cameras.single_mut()) else { return };
    let place = character.translation;
    *camera = Transform::from_translation(place + Vec3::new(3.5, 2.2, 4.0))
        .looking_at(place + Vec3::Y * 0.8, Vec3::Y);
}

#[derive(Resource)]
struct Picture(String);

fn take_picture(
    mut commands: Commands,
    time: Res<Time>,
    real: Res<Time<Real>>,
    picture: Res<Picture>,
    mut taken: Local<f32>,
    mut frames: Local<(u32, f32)>,
) {
    // Bevy's clock is slower than the real one where a frame takes over a quarter of a second.
    let now = time.elapsed_secs();
    // The first seconds load assets and compile shaders.
    if now > 4.0 && *taken == 0.0 {
        *frames = (frames.0 + 1, frames.1 + real.delta_secs());
    }
    if now > 8.0 && *taken == 0.0 {
        *taken = now;
        info!("{:.1} ms a frame", 1000.0 * frames.1 / frames.0 as f32);
        commands.spawn(Screenshot::primary_window()).observe(save_to_disk(picture.0.clone()));
    } else if *taken > 0.0 && now > *taken + 4.0 {
        commands.write_message(AppExit::Success);
    }
}

/// Boxes and balls with mesh and collider.
#[derive(bevy::ecs::system::SystemParam)]
pub struct Boxes<'w> {
    meshes: ResMut<'w, Assets<Mesh>>,
    materials: ResMut<'w, Assets<StandardMaterial>>,
}

impl Boxes<'_> {
    pub fn part(&mut self, size: Vec3, color: Color, place: Transform) -> impl Bundle + use<> {
        let mesh = self.meshes.add(Cuboid::from_size(size));
        let half = size / 2.0;
        (
            Mesh3d(mesh),
            MeshMaterial3d(self.materials.add(color)),
            Collider::cuboid(half.x, half.y, half.z),
            place,
        )
    }

    pub fn ball(&mut self, radius: f32, color: Color, place: Transform) -> impl Bundle + use<> {
        let mesh = self.meshes.add(Sphere::new(radius));
        (Mesh3d(mesh), MeshMaterial3d(self.materials.add(color)), Collider::ball(radius), place)
    }
}
