//! Sculpts the mannequin that stands in `assets/humanoid.glb`: signed distance shapes for each body, meshed by
//! surface nets, with skin, normals, two materials and baked ambient occlusion. Deterministic: the file in the
//! assets is exactly what [`generate`] returns, and a test holds it to that.

mod anatomy;
mod bone;
mod field;
mod glb;
mod markings;
mod rim;
mod sculpt;
mod shell;
mod simplify;
mod surface_nets;

pub use anatomy::{REST_OFFSETS, rest_positions};
use simplify::simplified;

/// Cells of the levels of detail, in units of the sizes in `anatomy`: close by, further off, and for a processor that draws.
const COARSENESS: [f32; 3] = [1.4, 1.9, 3.4];
/// Edge of the cells in which vertices of the last of these become one, for crowds, metres.
const CROWD_CELL_M: f32 = 0.08;

/// Bytes of the mannequin as glTF 2.0 binary, about 2.2 MB. Takes about a second.
#[must_use]
pub fn generate() -> Vec<u8> {
    let sculpture = sculpt::Sculpture::new();
    let [near, far, drawn] = COARSENESS.map(|cells| sculpture.figure(cells));
    let crowd = (
        simplified(&sculpture.plain_shells(COARSENESS[2]), CROWD_CELL_M),
        simplified(&drawn.1, CROWD_CELL_M),
    );
    glb::write(&[near, far, drawn, crowd])
}
