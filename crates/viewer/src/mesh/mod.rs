//! A glTF character as the renderer takes it: vertices in mesh space, joints tied to the bodies of a skeleton.
//!
//! A glTF binary fits when its nodes carry the names of the bodies, either as joints of a skin or with a mesh on each
//! body. Its rest pose stands for the character's pose with all joints at zero. Limbs that point elsewhere, such as
//! the arms of a T-pose, are turned. Anything wrong is refused with a [`MeshError`] before it is uploaded.

mod binding;
mod error;
mod load;
mod parse;
mod primitive;
mod read;
mod rig;

use std::path::Path;

use bytemuck::{Pod, Zeroable};
use glam::{Affine3A, Mat3A, Quat, Vec3};
use policy_core::BodyId;

use crate::files;
pub use error::MeshError;
pub use rig::Rig;

/// Most vertices a mesh may have, all levels together.
pub const MAX_VERTICES: usize = 2_000_000;
/// Most indices a mesh may have, all levels together.
pub const MAX_INDICES: usize = 6 * MAX_VERTICES;
/// Most joints a mesh may have.
pub const MAX_JOINTS: usize = 256;
/// Largest `.glb` that is read, bytes.
pub const MAX_MESH_BYTES: u64 = 64 << 20;

/// A vertex as the vertex buffer holds it.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct MeshVertex {
    /// Mesh space, metres.
    pub position: [f32; 3],
    /// Mesh space, unit length.
    pub normal: [f32; 3],
    /// Multiplies the colour of the material; how open the vertex is to light.
    pub colour: [u8; 4],
    /// Indices into [`SkinnedMesh::joints`].
    pub joints: [u8; 4],
    /// How much the vertex follows each joint, 255 in all.
    pub follow: [u8; 4],
}

/// A physically based surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Linear colour.
    pub colour: [f32; 3],
    /// 0 mirror, 1 matt.
    pub roughness: f32,
    /// 0 or 1.
    pub metallic: f32,
    /// True when the tint of an instance recolours it.
    pub tinted: bool,
}

/// Triangles of one material.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Index into [`SkinnedMesh::materials`].
    pub material: usize,
    /// Range of indices in the level.
    pub indices: std::ops::Range<u32>,
}

/// One level of detail.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Level {
    /// All vertices.
    pub vertices: Vec<MeshVertex>,
    /// All triangles.
    pub indices: Vec<u32>,
    /// One entry for each material.
    pub parts: Vec<Part>,
}

/// What a joint of the mesh follows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint {
    /// The body.
    pub body: BodyId,
    /// Mesh space to the frame of the body.
    pub body_from_mesh: Affine3A,
}

/// A character ready to be drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct SkinnedMesh {
    /// Joints in the order that vertices refer to.
    pub joints: Vec<Joint>,
    /// Materials.
    pub materials: Vec<Material>,
    /// Finest first; at least one. A coarse level serves crowds.
    pub levels: Vec<Level>,
}

impl SkinnedMesh {
    /// Reads a `.glb` file for the bodies of `rig`.
    ///
    /// # Errors
    /// When it can't be read, and as [`SkinnedMesh::from_bytes`]; the message names the file.
    pub fn load(path: &Path, rig: &Rig) -> Result<Self, MeshError> {
        let in_file = |source| MeshError::File { path: path.to_owned(), source: Box::new(source) };
        let bytes = files::read(path, MAX_MESH_BYTES).map_err(|error| in_file(error.into()))?;
        Self::from_bytes(&bytes, rig).map_err(in_file)
    }

    /// Reads the bytes of a `.glb` file for the bodies of `rig`.
    ///
    /// # Errors
    /// When they are no glTF binary or more than [`MAX_MESH_BYTES`], when bodies, skin or normals are missing, when
    /// a count or index is out of range or a number is not finite.
    pub fn from_bytes(bytes: &[u8], rig: &Rig) -> Result<Self, MeshError> {
        load::load(bytes, rig)
    }

    /// Appends the matrix of each joint for a character whose bodies are at `positions` and `rotations`, as three
    /// rows each.
    ///
    /// # Panics
    /// When there are fewer bodies than in the rig that the mesh was read for.
    pub fn palette_into(&self, positions: &[Vec3], rotations: &[Quat], out: &mut Vec<[[f32; 4]; 3]>) {
        for joint in &self.joints {
            let i = joint.body.index();
            let world_from_body =
                Affine3A { matrix3: Mat3A::from_quat(rotations[i]), translation: positions[i].into() };
            let world_from_mesh = world_from_body * joint.body_from_mesh;
            let (m, t) = (world_from_mesh.matrix3.transpose(), world_from_mesh.translation);
            out.push(
                [m.x_axis.extend(t.x), m.y_axis.extend(t.y), m.z_axis.extend(t.z)].map(|r| r.to_array()),
            );
        }
    }
}
