//! Files dropped on the window: a character pack or a mesh, told apart by their first bytes.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use policy_core::{CharacterPack, PackError};

use crate::files::{self, ReadError};
use crate::mesh::{MeshError, Rig, SkinnedMesh};
use crate::sim::SimError;

/// Largest file that is read, bytes: a pack, with a mesh inside.
pub const MAX_DROPPED_BYTES: u64 = 128 << 20;

/// What a file holds.
#[derive(Debug)]
pub enum Dropped {
    /// A mesh to draw.
    Mesh(Box<SkinnedMesh>),
    /// A pack to steer with.
    Pack(Arc<CharacterPack>),
}

/// Why a file can't be opened. The demo keeps what it has.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DroppedError {
    /// It can't be read.
    #[error("{}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: ReadError,
    },
    /// It is neither a pack nor a mesh.
    #[error("{}: expected a character pack (.safetensors) or a mesh (.glb), found neither", path.display())]
    Unknown {
        /// The file.
        path: PathBuf,
    },
    /// It looks like a mesh and is none that can be drawn.
    #[error("mesh {}: {source}", path.display())]
    Mesh {
        /// The file.
        path: PathBuf,
        /// Why.
        source: MeshError,
    },
    /// It looks like a pack and is none that can be run.
    #[error("pack {}: {source}", path.display())]
    Pack {
        /// The file.
        path: PathBuf,
        /// Why.
        source: PackError,
    },
    /// A replay keeps to the pack that it began with.
    #[error("another character can't be opened while a replay is recorded or played")]
    Replaying,
    /// The pack's body can't be simulated.
    #[error("pack {}: {source}", path.display())]
    Body {
        /// The file.
        path: PathBuf,
        /// Why.
        source: SimError,
    },
}

impl Dropped {
    /// Opens a file. A mesh has to fit `rig`.
    ///
    /// # Errors
    /// [`DroppedError`], which names the file.
    pub fn load(path: &Path, rig: &Rig) -> Result<Self, DroppedError> {
        let path_buf = || path.to_owned();
        let bytes = files::read(path, MAX_DROPPED_BYTES)
            .map_err(|source| DroppedError::Read { path: path_buf(), source })?;
        if bytes.starts_with(b"glTF") {
            let mesh = SkinnedMesh::from_bytes(&bytes, rig)
                .map_err(|source| DroppedError::Mesh { path: path_buf(), source })?;
            return Ok(Self::Mesh(Box::new(mesh)));
        }
        if !looks_like_a_pack(&bytes) {
            return Err(DroppedError::Unknown { path: path_buf() });
        }
        let pack = CharacterPack::from_bytes(&bytes)
            .map_err(|source| DroppedError::Pack { path: path_buf(), source })?;
        Ok(Self::Pack(Arc::new(pack)))
    }
}

/// What is said of a pack whose file has no checksum; `None` for others.
#[must_use]
pub fn word_about(pack: &CharacterPack) -> Option<&'static str> {
    (!pack.is_verified()).then_some("the pack has no checksum: damage to its file would not be noticed")
}

/// Safetensors begin with the length of their header, eight bytes, and the header is a JSON object.
fn looks_like_a_pack(bytes: &[u8]) -> bool {
    bytes.get(8) == Some(&b'{')
}
