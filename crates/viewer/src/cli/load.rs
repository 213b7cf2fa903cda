//! Reads what the command line names: pack and mesh.

use std::borrow::Cow;
use std::path::Path;
use std::sync::Arc;

use anyhow::Context as _;
use physics_bridge::Model;
use policy_core::CharacterPack;

use crate::appearance;
use crate::assets;
use crate::dropped::MAX_DROPPED_BYTES;
use crate::files;
use crate::mesh::SkinnedMesh;
use crate::render::Appearance;

/// The pack of a file, or the one inside.
///
/// # Errors
/// When the file can't be read or is no pack; the message names it.
pub fn pack(path: Option<&Path>) -> anyhow::Result<Arc<CharacterPack>> {
    let bytes = pack_bytes(path)?;
    let which = || path.map_or("the pack inside the demo".into(), |path| format!("pack {}", path.display()));
    Ok(Arc::new(CharacterPack::from_bytes(&bytes).with_context(which)?))
}

/// The bytes of the pack of a file, or of the one inside.
///
/// # Errors
/// When the file can't be read; the message names it.
pub fn pack_bytes(path: Option<&Path>) -> anyhow::Result<Cow<'static, [u8]>> {
    let Some(path) = path else { return Ok(assets::HUMANOID_PACK.into()) };
    let bytes = files::read(path, MAX_DROPPED_BYTES).with_context(|| format!("pack {}", path.display()))?;
    Ok(bytes.into())
}

/// How the characters of a pack look: with the mesh of a file, else with the pack's own, else with the mannequin if it
/// fits the skeleton. Also returns what is wrong with the file or with the pack's mesh.
#[must_use]
pub fn appearance(path: Option<&Path>, pack: &CharacterPack, model: &Model) -> (Appearance, Option<String>) {
    let mut complaint = None;
    if let Some(path) = path {
        match SkinnedMesh::load(path, &appearance::rig(model)) {
            Ok(mesh) => return (Appearance::new(model.skeleton(), Some(mesh)), None),
            Err(error) => complaint = Some(error.to_string()),
        }
    }
    let (appearance, of_pack) = appearance::of_pack(pack, model);
    (appearance, complaint.or(of_pack))
}
