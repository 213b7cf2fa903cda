//! Meshes of a character's colliders, for a game that has no skin for it yet.

use bevy::prelude::*;
use bevy_rapier3d::plugin::context::systemparams::ReadRapierContext;
use bevy_rapier3d::rapier::geometry::TypedShape;

use crate::body;
use crate::body::PolicyBodies;
use crate::character::PolicyController;
use crate::rapier::RapierArticulation;

/// Shows a character as its colliders.
#[derive(Component, Reflect, Clone, Copy, Debug)]
#[reflect(Component)]
pub struct BodyMeshes {
    /// Of all its parts.
    pub color: Color,
}

impl Default for BodyMeshes {
    fn default() -> Self {
        Self { color: Color::srgb(0.85, 0.55, 0.35) }
    }
}

/// On a body that has its meshes.
#[derive(Component)]
struct Shown;

/// Gives meshes to characters with [`BodyMeshes`].
#[derive(Clone, Copy, Debug, Default)]
pub struct BodyMeshesPlugin;

impl Plugin for BodyMeshesPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<BodyMeshes>().add_systems(Update, show);
        #[cfg(feature = "mujoco")]
        app.add_systems(Update, show_in_mujoco);
    }
}

fn show(
    mut commands: Commands,
    characters: Query<(&BodyMeshes, &PolicyBodies, &PolicyController, &RapierArticulation)>,
    shown: Query<(), With<Shown>>,
    context: ReadRapierContext,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let Ok(context) = context.single() else { return };
    for (wanted, bodies, controller, own) in &characters {
        if bodies.entities().iter().all(|&entity| shown.contains(entity)) {
            continue;
        }
        let material = materials.add(StandardMaterial { base_color: wanted.color, ..default() });
        for ((&entity, &handle), frame) in
            bodies.entities().iter().zip(own.articulation().bodies()).zip(body::poses(controller))
        {
            let rapier = context.rigidbody_set.bodies.get(handle);
            let Some(rapier) = rapier.filter(|_| !shown.contains(entity)) else { continue };
            commands.entity(entity).try_insert(Shown);
            // Rapier's frame of the root is at its centre of mass; the entity's is the MJCF's.
            let frame_from_rapier = Transform::from_isometry(frame).to_matrix().inverse()
                * Mat4::from_rotation_translation(*rapier.rotation(), rapier.translation());
            for &collider in rapier.colliders() {
                let Some(collider) = context.colliders.colliders.get(collider) else { continue };
                let within = collider.position_wrt_parent().copied().unwrap_or_default();
                let Some((mesh, own)) = mesh_of(collider.shape().as_typed_shape()) else { continue };
                let at = frame_from_rapier
                    * Mat4::from_rotation_translation(within.rotation, within.translation)
                    * own.to_matrix();
                let mesh = (Mesh3d(meshes.add(mesh)), MeshMaterial3d(material.clone()));
                spawn_below(&mut commands, entity, (mesh, Transform::from_matrix(at)));
            }
        }
    }
}

/// The same for characters in MuJoCo, whose shapes are in the frames of the bodies.
#[cfg(feature = "mujoco")]
fn show_in_mujoco(
    mut commands: Commands,
    characters: Query<(&BodyMeshes, &PolicyBodies, &crate::MujocoBody)>,
    shown: Query<(), With<Shown>>,
    world: Option<Res<crate::MujocoWorld>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    use physics_bridge::ShapeKind;

    let Some(world) = world.as_ref().and_then(|own| own.world()) else { return };
    for (wanted, bodies, own) in &characters {
        let Ok(model) = world.model(own.handle()) else { continue };
        if bodies.entities().iter().all(|&entity| shown.contains(entity)) {
            continue;
        }
        let material = materials.add(StandardMaterial { base_color: wanted.color, ..default() });
        // Also those without a shape, which would be looked at again in each frame.
        for &entity in bodies.entities() {
            commands.entity(entity).try_insert(Shown);
        }
        for shape in model.shapes() {
            let entity = bodies.entities().get(shape.body.index());
            let Some(&entity) = entity.filter(|&&entity| !shown.contains(entity)) else { continue };
            let (mesh, turn): (Mesh, Quat) = match shape.kind {
                ShapeKind::Sphere { radius } => (Sphere::new(radius).into(), Quat::IDENTITY),
                ShapeKind::Capsule { radius, half_length } => {
                    let along_z = Quat::from_rotation_arc(Vec3::Y, Vec3::Z);
                    (Capsule3d::new(radius, 2.0 * half_length).into(), along_z)
                }
                ShapeKind::Cuboid { half_extents } => {
                    (Cuboid::from_size(2.0 * half_extents).into(), Quat::IDENTITY)
                }
                _ => continue,
            };
            let mesh = (Mesh3d(meshes.add(mesh)), MeshMaterial3d(material.clone()));
            let at = Transform::from_translation(shape.position).with_rotation(shape.rotation * turn);
            spawn_below(&mut commands, entity, (mesh, at));
        }
    }
}

/// Spawns a child, unless the game has despawned the parent by now.
fn spawn_below(commands: &mut Commands, parent: Entity, child: impl Bundle) {
    commands.queue(move |world: &mut World| {
        if world.get_entity(parent).is_ok() {
            world.spawn((child, ChildOf(parent)));
        }
    });
}

/// The mesh of a shape, and where it lies in the collider.
fn mesh_of(shape: TypedShape<'_>) -> Option<(Mesh, Transform)> {
    match shape {
        TypedShape::Ball(ball) => Some((Sphere::new(ball.radius).into(), Transform::IDENTITY)),
        TypedShape::Cuboid(cuboid) => {
            Some((Cuboid::from_size(2.0 * cuboid.half_extents).into(), Transform::IDENTITY))
        }
        TypedShape::Capsule(capsule) => {
            let (a, b) = (capsule.segment.a, capsule.segment.b);
            let turn = Quat::from_rotation_arc(Vec3::Y, (b - a).normalize_or(Vec3::Y));
            let at = Transform { translation: (a + b) / 2.0, rotation: turn, ..default() };
            Some((Capsule3d::new(capsule.radius, (b - a).length()).into(), at))
        }
        _ => None,
    }
}
