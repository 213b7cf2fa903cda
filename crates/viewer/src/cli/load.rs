//! Reads what the command line names: pack, mesh, script.

use std::path::Path;
use std::sync::Arc;

use anyhow::Context as _;
use policy_core::CharacterPack;

use crate::assets;
use crate::dropped::MAX_DROPPED_BYTES;
use crate::files;
use crate::mesh::SkinnedMesh;

/// The pack of a file, or the one inside.
///
/// # Errors
/// When the file can't be read or is no pack; the message names it.
pub fn pack(path: Option<&Path>) -> anyhow::Result<Arc<CharacterPack>> {
    let Some(path) = path else {
        let pack = CharacterPack::from_bytes(assets::HUMANOID_PACK).context("the pack inside the demo")?;
        return Ok(Arc::new(pack));
    };
    let bytes = files::read(path, MAX_DROPPED_BYTES).with_context(|| format!("pack {}", path.display()))?;
    let pack = CharacterPack::from_bytes(&bytes).with_context(|| format!("pack {}", path.display()))?;
    Ok(Arc::new(pack))
}

/// The humanoid of a file. When it is no good: the one inside, and what is wrong with the file.
///
/// # Errors
/// When the humanoid inside is broken, which no build should be.
pub fn mesh(path: Option<&Path>) -> anyhow::Result<(SkinnedMesh, Option<String>)> {
    let mut complaint = None;
    if let Some(path) = path {
        match SkinnedMesh::load(path) {
            Ok(mesh) => return Ok((mesh, None)),
            Err(error) => complaint = Some(error.to_string()),
        }
    }
    let mesh = SkinnedMesh::from_bytes(assets::HUMANOID_GLB).context("the mesh inside the demo")?;
    Ok((mesh, complaint))
}
