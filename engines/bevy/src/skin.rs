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
    #[entities]
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
    /// Its rotation in the model while all is at rest.
    rest: Quat,
    /// Index of its body.
    body: Option<usize>,
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

/// Binds skins whose bones are there, and binds them again when bones are gone: a glTF that was loaded again has new ones.
fn bind(
    mut commands: Commands,
    skins: Query<(Entity, &PolicySkin, Option<&SkinBinding>)>,
    characters: Query<&PolicyController, With<PolicyBodies>>,
    children: Query<&'static Children>,
    nodes: Query<(&'static Transform, Option<&'static Name>)>,
) {
    for (entity, skin, bound) in &skins {
        let bound = bound.map_or(&[][..], |binding| &binding.0);
        if !bound.is_empty() && bound.iter().all(|node| nodes.contains(node.entity)) {
            continue;
        }
        let Ok(controller) = characters.get(skin.character) else { continue };
        let mut binding = Vec::new();
        let tree = Tree { skin, controller, bound, children: &children, nodes: &nodes };
        tree.add(entity, None, Quat::IDENTITY, &mut binding);
        if binding.iter().any(|node| node.body.is_some()) {
            commands.entity(entity).try_insert(SkinBinding(binding));
        }
    }
}

struct Tree<'a, 'w, 's> {
    skin: &'a PolicySkin,
    controller: &'a PolicyController,
    /// What was bound before.
    bound: &'a [Node],
    children: &'a Query<'w, 's, &'static Children>,
    nodes: &'a Query<'w, 's, (&'static Transform, Option<&'static Name>)>,
}

impl Tree<'_, '_, '_> {
    /// Adds everything below an entity whose rotation in the model is `above_rest`.
    fn add(&self, above: Entity, parent: Option<usize>, above_rest: Quat, out: &mut Vec<Node>) {
        let skeleton = self.controller.controller.pack().skeleton();
        for &entity in self.children.get(above).into_iter().flatten() {
            let Ok((transform, name)) = self.nodes.get(entity) else { continue };
            // What was bound before is no longer at rest.
            let known = self.bound.iter().find(|node| node.entity == entity);
            let rest = known.map_or(above_rest * transform.rotation, |node| node.rest);
            let named = |body: &str| name.is_some_and(|name| name.as_str() == self.skin.bone(body));
            let body = skeleton.bodies().iter().position(|body| named(&body.name));
            out.push(Node { entity, parent, rest, body });
            self.add(entity, Some(out.len() - 1), rest, out);
        }
    }
}

/// Rotation of a bone in the frame of its body, of the rest poses of both.
fn offset(rest: &CharacterState, body: usize, bone: Quat) -> Option<Quat> {
    Some(rest.bodies.get(body)?.rotation.inverse() * POLICY_FROM_GLTF * bone)
}

/// Writes the `Transform` of bones.
fn follow(
    skins: Query<(Entity, &PolicySkin, &SkinBinding)>,
    characters: Query<(&PolicyBodies, &PolicyController)>,
    parents: Query<&ChildOf>,
    mut transforms: Query<&mut Transform>,
    mut worlds: Local<Vec<GlobalTransform>>,
) {
    for (entity, skin, binding) in &skins {
        let Ok((bodies, controller)) = characters.get(skin.character) else { continue };
        let own = world(entity, &parents, &transforms);
        worlds.clear();
        for node in &binding.0 {
            let above = node.parent.map_or(own, |parent| worlds[parent]);
            let place = node.body.and_then(|body| {
                // A pack that was loaded again may have another rest pose.
                let offset = offset(&controller.rest, body, node.rest)?;
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
