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

/// Set when the meshes are there.
#[derive(Component)]
struct Shown;

/// Gives meshes to characters with [`BodyMeshes`].
#[derive(Clone, Copy, Debug, Default)]
pub struct BodyMeshesPlugin;

impl Plugin for BodyMeshesPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<BodyMeshes>().add_systems(Update, show);
    }
}

fn show(
    mut commands: Commands,
    characters: Query<
        (Entity, &BodyMeshes, &PolicyBodies, &PolicyController, &RapierArticulation),
        Without<Shown>,
    >,
    context: ReadRapierContext,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let Ok(context) = context.single() else { return };
    for (character, wanted, bodies, controller, own) in &characters {
        let material = materials.add(StandardMaterial { base_color: wanted.color, ..default() });
        for ((&entity, &handle), frame) in
            bodies.entities().iter().zip(own.articulation().bodies()).zip(body::poses(controller))
        {
            let Some(rapier) = context.rigidbody_set.bodies.get(handle) else { continue };
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
                commands.spawn((
                    Mesh3d(meshes.add(mesh)),
                    MeshMaterial3d(material.clone()),
                    Transform::from_matrix(at),
                    ChildOf(entity),
                ));
            }
        }
        commands.entity(character).insert(Shown);
    }
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
