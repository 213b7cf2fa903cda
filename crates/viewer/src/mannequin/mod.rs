//! Sculpts the mannequin that stands in `assets/humanoid.glb`: signed distance shapes for each body, meshed by
//! surface nets, with skin, normals, two materials and baked ambient occlusion. Deterministic: the file in the
//! assets is exactly what [`generate`] returns, and a test holds it to that.

mod anatomy;
mod field;
mod glb;
mod sculpt;
mod surface_nets;

pub use anatomy::{REST_OFFSETS, rest_positions};

/// Cells of the mesh for few characters and of that for crowds, in units of the sizes in `anatomy`.
const COARSENESS: [f32; 2] = [1.45, 2.7];

/// Bytes of the mannequin as glTF 2.0 binary, below 1 MB. Takes about a second.
#[must_use]
pub fn generate() -> Vec<u8> {
    let sculpture = sculpt::Sculpture::new();
    let levels = COARSENESS.map(|c| (sculpture.shells(c), sculpture.suit(c)));
    glb::write(&levels)
}
