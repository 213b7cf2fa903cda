//! Sculpts the mannequin that stands in `assets/humanoid.glb`: signed distance shapes for each body, meshed by
//! surface nets, with skin, normals, two materials and baked ambient occlusion. Deterministic: the file in the
//! assets is exactly what [`generate`] returns, and a test holds it to that.

mod anatomy;
mod bone;
mod field;
mod glb;
mod sculpt;
mod surface_nets;

pub use anatomy::{REST_OFFSETS, rest_positions};

/// Cells of the levels of detail, in units of the sizes in `anatomy`: close by, further off, for a processor that draws, and for crowds.
const COARSENESS: [f32; 4] = [1.4, 1.9, 2.8, 7.0];

/// Bytes of the mannequin as glTF 2.0 binary, about 1.4 MB. Takes about a second.
#[must_use]
pub fn generate() -> Vec<u8> {
    let sculpture = sculpt::Sculpture::new();
    let levels = COARSENESS.map(|c| (sculpture.shells(c), sculpture.suit(c)));
    glb::write(&levels)
}
