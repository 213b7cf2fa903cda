//! Sculpts the mannequin that stands in `assets/humanoid.glb`: signed distance shapes for each body, meshed by
//! surface nets, with skin, normals, two materials and baked ambient occlusion. Deterministic: the file in the
//! assets is exactly what [`generate`] returns, and a test holds it to that.

mod anatomy;
mod field;
mod glb;
mod sculpt;
mod surface_nets;

pub use anatomy::{REST_OFFSETS, rest_positions};

/// How much coarser the mesh for crowds is.
const CROWD_COARSENESS: f32 = 2.6;

/// Bytes of the mannequin as glTF 2.0 binary, about 1 MB. Takes about a second.
#[must_use]
pub fn generate() -> Vec<u8> {
    let sculpture = sculpt::Sculpture::new();
    let levels = [1.0, CROWD_COARSENESS].map(|c| (sculpture.shells(c), sculpture.suit(c)));
    glb::write(&levels)
}
