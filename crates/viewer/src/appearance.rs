//! How the characters of a pack look by default.

use physics_bridge::Model;
use policy_core::CharacterPack;

use crate::assets;
use crate::mesh::{Rig, SkinnedMesh};
use crate::render::Appearance;
use crate::sim::rest_positions;

/// What a mesh for the characters of `model` is bound to.
#[must_use]
pub fn rig(model: &Model) -> Rig {
    Rig::new(model.skeleton().clone(), rest_positions(model))
}

/// The mesh of the pack, else the mannequin if it fits the skeleton, else none. Also returns what is wrong with the
/// pack's own mesh.
#[must_use]
pub fn of_pack(pack: &CharacterPack, model: &Model) -> (Appearance, Option<String>) {
    let rig = rig(model);
    let (mut mesh, mut complaint) = (None, None);
    if let Some(bytes) = pack.mesh() {
        match SkinnedMesh::from_bytes(bytes, &rig) {
            Ok(found) => mesh = Some(found),
            Err(error) => complaint = Some(format!("the mesh of the pack: {error}")),
        }
    }
    // The mannequin fits every skeleton whose bodies have its names.
    let mesh = mesh.or_else(|| SkinnedMesh::from_bytes(assets::HUMANOID_GLB, &rig).ok());
    (Appearance::new(model.skeleton(), mesh), complaint)
}
