//! What can be wrong with the glTF of a character.

use std::path::PathBuf;

/// Why a glTF can't be the mesh of a character.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// Something is wrong with a file.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: Box<MeshError>,
    },
    /// The file can't be read, or is too large.
    #[error(transparent)]
    Read(#[from] crate::files::ReadError),
    /// The bytes are no glTF 2.0.
    #[error("expected glTF 2.0 binary (.glb), found: {0}")]
    Parse(gltf::Error),
    /// The binary chunk is missing.
    #[error("expected a .glb with its data inside, found none (export as one binary file)")]
    NoBinary,
    /// The data ends before a buffer, a view or an accessor does.
    #[error("{what} {index}: expected data up to byte {expected}, found {found} bytes")]
    Truncated {
        /// `buffer`, `buffer view` or `accessor`.
        what: &'static str,
        /// Its index in the document.
        index: usize,
        /// Where it ends.
        expected: u64,
        /// How much there is.
        found: u64,
    },
    /// A feature of glTF that is not supported.
    #[error("{what} is not supported")]
    Unsupported {
        /// The feature and where it is.
        what: String,
    },
    /// Neither a skin nor meshes on nodes that carry body names.
    #[error("expected a skin, or meshes on nodes named after the bodies, found {meshes} meshes and no skin")]
    NoSkin {
        /// Meshes in the document.
        meshes: usize,
    },
    /// Bodies that no node carries.
    #[error("expected a node for every body, found none named {}", missing.join(", "))]
    MissingBodies {
        /// Names of the bodies.
        missing: Vec<String>,
    },
    /// A vertex attribute is missing.
    #[error("mesh {mesh}, primitive {primitive}: expected the attribute {attribute}, found none")]
    MissingAttribute {
        /// Name or index of the mesh.
        mesh: String,
        /// Index of the primitive.
        primitive: usize,
        /// Name of the attribute.
        attribute: &'static str,
    },
    /// Arrays of different length, or an index that points past the end.
    #[error("mesh {mesh}, primitive {primitive}: expected {expected}, found {found}")]
    Inconsistent {
        /// Name or index of the mesh.
        mesh: String,
        /// Index of the primitive.
        primitive: usize,
        /// What should be.
        expected: String,
        /// What is.
        found: String,
    },
    /// More of something than any character needs.
    #[error("expected at most {most} {what}, found {found}")]
    TooMany {
        /// What there is too much of.
        what: &'static str,
        /// The limit.
        most: usize,
        /// The count.
        found: usize,
    },
}
