//! The skinned mesh of a glTF follows the bodies, by the names of its bones.

use bevy::prelude::*;
use bevy::transform::TransformSystems;
use policy_core::CharacterState;

use crate::body::PolicyBodies;
use crate::character::PolicyController;

/// Turns a model of glTF, y up and facing z, into the policies' world, z up and facing x.
const POLICY_FROM_GLTF: Quat = Quat::from_xyzw(0.5, 0.5, 0.5, 0.5);

/// Makes the bones below this entity follow a character. Put it beside the root of a glTF's world.
///
/// Each bone that is called as a body turns with it; the bone of the root moves with it too. Bones without a body keep
/// their pose to their parent. The rest pose of the mesh has to be that of the pack's body with all joints at zero: for
/// the humanoid it stands, arms down.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component)]
#[require(Transform)]
#[cfg_attr(feature = "render", require(Visibility))]
pub struct PolicySkin {
    /// The character.
    pub character: Entity,
    /// Pairs of body and bone whose names differ.
    pub renamed: Vec<(String, String)>,
}

impl PolicySkin {
    /// A skin whose bones are called as the bodies.
    #[must_use]
    pub fn of(character: Entity) -> Self {
        Self { character, renamed: Vec::new() }
    }

    fn bone<'a>(&'a self, body: &'a str) -> &'a str {
        self.renamed.iter().find(|(own, _)| own == body).map_or(body, |(_, bone)| bone)
    }
}

/// The entities below a skin, parents first.
#[derive(Component)]
struct SkinBinding(Vec<Node>);

struct Node {
    entity: Entity,
    /// Index of its parent; `None` below the skin itself.
    parent: Option<usize>,
    /// Index of its body, and the bone's rotation in the body's frame.
    body: Option<(usize, Quat)>,
}

/// Lets skins follow their characters.
#[derive(Clone, Copy, Debug, Default)]
pub struct PolicySkinPlugin;

impl Plugin for PolicySkinPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<PolicySkin>()
            .add_systems(PostUpdate, (bind, follow).chain().before(TransformSystems::Propagate));
    }
}

/// Binds skins whose bones are there.
fn bind(
    mut commands: Commands,
    skins: Query<(Entity, &PolicySkin), Without<SkinBinding>>,
    characters: Query<&PolicyController, With<PolicyBodies>>,
    children: Query<&'static Children>,
    nodes: Query<(&'static Transform, Option<&'static Name>)>,
) {
    for (entity, skin) in &skins {
        let Ok(controller) = characters.get(skin.character) else { continue };
        let mut binding = Vec::new();
        let tree = Tree { skin, controller, children: &children, nodes: &nodes };
        tree.add(entity, None, Quat::IDENTITY, &mut binding);
        if binding.iter().any(|node| node.body.is_some()) {
            commands.entity(entity).insert(SkinBinding(binding));
        }
    }
}

struct Tree<'a, 'w, 's> {
    skin: &'a PolicySkin,
    controller: &'a PolicyController,
    children: &'a Query<'w, 's, &'static Children>,
    nodes: &'a Query<'w, 's, (&'static Transform, Option<&'static Name>)>,
}

impl Tree<'_, '_, '_> {
    /// Adds everything below an entity whose rotation in the model is `rotation`.
    fn add(&self, above: Entity, parent: Option<usize>, rotation: Quat, out: &mut Vec<Node>) {
        let skeleton = self.controller.controller.pack().skeleton();
        for &entity in self.children.get(above).into_iter().flatten() {
            let Ok((transform, name)) = self.nodes.get(entity) else { continue };
            let rotation = rotation * transform.rotation;
            let named = |body: &str| name.is_some_and(|name| name.as_str() == self.skin.bone(body));
            let body = skeleton.bodies().iter().position(|body| named(&body.name));
            let body = body.map(|body| (body, offset(&self.controller.rest, body, rotation)));
            out.push(Node { entity, parent, body });
            self.add(entity, Some(out.len() - 1), rotation, out);
        }
    }
}

/// Rotation of a bone in the frame of its body, of the rest poses of both.
fn offset(rest: &CharacterState, body: usize, bone: Quat) -> Quat {
    rest.bodies[body].rotation.inverse() * POLICY_FROM_GLTF * bone
}

/// Writes the `Transform` of bones.
fn follow(
    skins: Query<(Entity, &PolicySkin, &SkinBinding)>,
    characters: Query<&PolicyBodies>,
    parents: Query<&ChildOf>,
    mut transforms: Query<&mut Transform>,
    mut worlds: Local<Vec<GlobalTransform>>,
) {
    for (entity, skin, binding) in &skins {
        let Ok(bodies) = characters.get(skin.character) else { continue };
        let own = world(entity, &parents, &transforms);
        worlds.clear();
        for node in &binding.0 {
            let above = node.parent.map_or(own, |parent| worlds[parent]);
            let place = node.body.and_then(|(body, offset)| {
                let place = transforms.get(*bodies.entities().get(body)?).ok()?;
                Some((body, place.translation, place.rotation * offset))
            });
            let Ok(mut local) = transforms.get_mut(node.entity) else {
                worlds.push(above);
                continue;
            };
            if let Some((body, translation, rotation)) = place {
                local.rotation = (above.rotation().inverse() * rotation).normalize();
                if body == 0 {
                    local.translation = above.affine().inverse().transform_point3(translation);
                }
            }
            worlds.push(above.mul_transform(*local));
        }
    }
}

/// Where an entity is in the world, by the `Transform`s of this frame.
fn world(entity: Entity, parents: &Query<&ChildOf>, transforms: &Query<&mut Transform>) -> GlobalTransform {
    let ancestors = std::iter::once(entity).chain(parents.iter_ancestors(entity));
    ancestors.fold(GlobalTransform::IDENTITY, |below, entity| {
        let own = transforms.get(entity).map_or(GlobalTransform::IDENTITY, |own| GlobalTransform::from(*own));
        own * below
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gltf_faces_along_x_with_z_up() {
        assert!((POLICY_FROM_GLTF * Vec3::Z - Vec3::X).length() < 1e-6);
        assert!((POLICY_FROM_GLTF * Vec3::Y - Vec3::Z).length() < 1e-6);
        assert!((POLICY_FROM_GLTF * Vec3::X - Vec3::Y).length() < 1e-6);
    }
}
