//! What the mannequin is made of: a dark suit that bends, and light shells, one rigid piece for each body.
//!
//! Every shape is given in the frame of its body with all joints at zero: x forward, y left, z up, metres. The
//! right side is written out, the left side is its mirror image. Sizes keep to the collision shapes of the
//! MJCF, so that the soles stand on the ground and nothing visible hangs in the air.

use glam::{Vec3, vec3};

use super::bone::Bone;
use super::field::Shape;

/// Position of each body in its parent with all joints at zero, in body order (the pelvis at the origin).
pub const REST_OFFSETS: [Vec3; 15] = [
    Vec3::ZERO,
    vec3(0.0, 0.0, 0.236_151),
    vec3(0.0, 0.0, 0.223_894),
    vec3(-0.02405, -0.18311, 0.2435),
    vec3(0.0, 0.0, -0.274_788),
    vec3(0.0, 0.0, -0.258_947),
    vec3(-0.02405, 0.18311, 0.2435),
    vec3(0.0, 0.0, -0.274_788),
    vec3(0.0, 0.0, -0.258_947),
    vec3(0.0, -0.084_887, 0.0),
    vec3(0.0, 0.0, -0.421_546),
    vec3(0.0, 0.0, -0.40987),
    vec3(0.0, 0.084_887, 0.0),
    vec3(0.0, 0.0, -0.421_546),
    vec3(0.0, 0.0, -0.40987),
];

/// Position of each body relative to the pelvis with all joints at zero, in body order.
#[must_use]
pub fn rest_positions() -> [Vec3; 15] {
    let mut positions = REST_OFFSETS;
    for body in Bone::ALL {
        if let Some(parent) = body.parent() {
            positions[body.index()] += positions[parent.index()];
        }
    }
    positions
}

/// A rigid shell piece.
pub(super) struct Piece {
    pub(super) body: Bone,
    pub(super) shapes: Vec<Shape>,
    /// Fillet between its shapes.
    pub(super) fillet: f32,
    /// Edge of a mesh cell at coarseness 1.
    pub(super) cell: f32,
    /// The piece is cut off below this height of its body frame.
    pub(super) floor: f32,
    /// Made of the suit's material.
    pub(super) dark: bool,
}

fn cone(a: Vec3, b: Vec3, ra: f32, rb: f32) -> Shape {
    Shape::Cone { a, b, ra, rb }
}

fn egg(centre: Vec3, radii: Vec3) -> Shape {
    Shape::Ellipsoid { centre, radii }
}

fn piece(body: Bone, fillet: f32, cell: f32, shapes: &[Shape]) -> Piece {
    Piece { body, shapes: shapes.to_vec(), fillet, cell, floor: f32::NEG_INFINITY, dark: false }
}

/// The shells: head, chest, pelvis, and both sides' arms and legs.
pub(super) fn shells() -> Vec<Piece> {
    let mut pieces = trunk();
    for right in right_limbs() {
        let left = right.body.mirrored();
        let shapes = right.shapes.iter().map(|s| s.mirrored()).collect();
        let mirrored = Piece { body: left, shapes, ..right };
        pieces.extend([right, mirrored]);
    }
    pieces
}

fn trunk() -> Vec<Piece> {
    let mut chest = vec![
        egg(vec3(0.0, 0.0, 0.15), vec3(0.107, 0.142, 0.125)),
        egg(vec3(0.0, 0.0, 0.055), vec3(0.097, 0.128, 0.084)),
    ];
    for side in [-1.0, 1.0] {
        chest.push(egg(vec3(0.052, 0.062 * side, 0.165), vec3(0.058, 0.072, 0.056)));
        chest.push(egg(vec3(-0.05, 0.07 * side, 0.17), vec3(0.055, 0.072, 0.085)));
        chest.push(cone(vec3(-0.012, 0.05 * side, 0.228), vec3(-0.022, 0.128 * side, 0.226), 0.048, 0.047));
    }
    let visor = egg(vec3(0.030, 0.0, 0.186), vec3(0.0835, 0.0745, 0.040));
    vec![
        Piece { dark: true, ..piece(Bone::Head, 0.02, 0.006, &[visor]) },
        piece(
            Bone::Head,
            0.035,
            0.0085,
            &[
                egg(vec3(0.008, 0.0, 0.188), vec3(0.098, 0.079, 0.098)),
                egg(vec3(0.036, 0.0, 0.135), vec3(0.060, 0.056, 0.062)),
                egg(vec3(0.078, 0.0, 0.098), vec3(0.022, 0.026, 0.018)),
            ],
        ),
        piece(Bone::Torso, 0.045, 0.012, &chest),
        piece(
            Bone::Pelvis,
            0.05,
            0.012,
            &[
                egg(vec3(0.0, 0.0, 0.062), vec3(0.103, 0.140, 0.072)),
                egg(vec3(0.0, 0.0, 0.0), vec3(0.078, 0.062, 0.075)),
                egg(vec3(-0.05, -0.055, 0.03), vec3(0.066, 0.07, 0.07)),
                egg(vec3(-0.05, 0.055, 0.03), vec3(0.066, 0.07, 0.07)),
            ],
        ),
    ]
}

fn right_limbs() -> Vec<Piece> {
    let mut pieces = vec![
        piece(
            Bone::RightUpperArm,
            0.04,
            0.0105,
            &[
                egg(vec3(0.0, 0.004, -0.012), vec3(0.057, 0.052, 0.060)),
                cone(vec3(0.0, 0.0, -0.06), vec3(0.0, 0.0, -0.218), 0.045, 0.038),
                egg(vec3(0.012, 0.0, -0.125), vec3(0.044, 0.044, 0.07)),
            ],
        ),
        piece(
            Bone::RightLowerArm,
            0.03,
            0.0105,
            &[
                cone(vec3(0.0, 0.0, -0.052), vec3(0.0, 0.0, -0.212), 0.040, 0.029),
                egg(vec3(0.004, -0.004, -0.085), vec3(0.046, 0.042, 0.068)),
            ],
        ),
        piece(Bone::RightHand, 0.012, 0.006, &right_hand()),
        piece(
            Bone::RightThigh,
            0.05,
            0.0125,
            &[
                cone(vec3(0.0, 0.004, -0.08), vec3(0.0, 0.0, -0.335), 0.070, 0.053),
                egg(vec3(0.018, -0.004, -0.17), vec3(0.070, 0.070, 0.135)),
            ],
        ),
        piece(
            Bone::RightShin,
            0.035,
            0.0115,
            &[
                cone(vec3(0.0, 0.0, -0.085), vec3(0.0, 0.0, -0.338), 0.050, 0.036),
                egg(vec3(-0.020, 0.0, -0.135), vec3(0.052, 0.052, 0.095)),
                egg(vec3(0.030, 0.0, -0.008), vec3(0.030, 0.040, 0.046)),
                cone(vec3(0.032, 0.0, -0.04), vec3(0.018, 0.0, -0.16), 0.024, 0.024),
            ],
        ),
    ];
    let mut shoe = piece(
        Bone::RightFoot,
        0.03,
        0.0085,
        &[
            egg(vec3(0.082, 0.0, -0.03), vec3(0.056, 0.046, 0.028)),
            egg(vec3(-0.008, 0.0, -0.018), vec3(0.042, 0.037, 0.04)),
            cone(vec3(0.0, 0.0, 0.0), vec3(0.072, 0.0, -0.028), 0.037, 0.024),
        ],
    );
    shoe.floor = -0.034;
    pieces.push(shoe);
    pieces.push(Piece { dark: true, ..piece(Bone::RightFoot, 0.02, 0.007, &[sole()]) });
    pieces
}

/// A loosely closed hand; the palm faces the thigh (towards +y on the right side).
fn right_hand() -> Vec<Shape> {
    let mut shapes = vec![
        egg(vec3(0.002, 0.0, -0.026), vec3(0.033, 0.019, 0.046)),
        cone(vec3(0.022, 0.006, -0.012), vec3(0.040, 0.014, -0.046), 0.0125, 0.0105),
        cone(vec3(0.040, 0.014, -0.046), vec3(0.036, 0.020, -0.072), 0.0105, 0.0090),
    ];
    for (i, reach) in [0.92_f32, 1.0, 1.04, 0.96].iter().enumerate() {
        let x = -0.0235 + 0.0165 * i as f32;
        let knuckle = vec3(x, -0.003, -0.060);
        let bend = vec3(x, 0.004, -0.060 - 0.032 * reach);
        let tip = vec3(x, 0.021, -0.060 - 0.048 * reach);
        shapes.push(cone(knuckle, bend, 0.0105, 0.0095));
        shapes.push(cone(bend, tip, 0.0095, 0.0080));
    }
    shapes
}

fn sole() -> Shape {
    Shape::Box { centre: vec3(0.045, 0.0, -0.039), half: vec3(0.0885, 0.044, 0.011), round: 0.0105 }
}

/// The suit under the shells, each shape with the body that carries it.
pub(super) fn suit() -> Vec<(Bone, Shape)> {
    let mut shapes = vec![
        (Bone::Pelvis, egg(vec3(0.0, 0.0, 0.05), vec3(0.088, 0.118, 0.09))),
        (Bone::Pelvis, egg(vec3(0.0, 0.0, 0.16), vec3(0.078, 0.098, 0.12))),
        (Bone::Torso, egg(vec3(0.0, 0.0, 0.11), vec3(0.09, 0.122, 0.16))),
        (Bone::Torso, egg(vec3(-0.01, 0.0, 0.2), vec3(0.07, 0.15, 0.065))),
        (Bone::Head, cone(vec3(-0.012, 0.0, -0.02), vec3(0.004, 0.0, 0.11), 0.054, 0.049)),
    ];
    for (body, shape) in right_suit() {
        shapes.push((body, shape));
        shapes.push((body.mirrored(), shape.mirrored()));
    }
    shapes
}

fn right_suit() -> Vec<(Bone, Shape)> {
    vec![
        (Bone::RightUpperArm, cone(vec3(0.0, 0.02, -0.01), vec3(0.0, 0.0, -0.26), 0.046, 0.029)),
        (Bone::RightLowerArm, cone(vec3(0.0, 0.0, 0.0), vec3(0.0, 0.0, -0.24), 0.0325, 0.0205)),
        (Bone::RightHand, cone(vec3(0.0, 0.0, 0.02), vec3(0.0, 0.0, -0.03), 0.021, 0.016)),
        (Bone::RightThigh, cone(vec3(0.0, 0.0, 0.01), vec3(0.0, 0.0, -0.4), 0.074, 0.041)),
        (Bone::RightShin, cone(vec3(0.0, 0.0, 0.0), vec3(0.0, 0.0, -0.38), 0.042, 0.027)),
        (Bone::RightFoot, cone(vec3(-0.002, 0.0, 0.005), vec3(0.0, 0.0, -0.02), 0.030, 0.030)),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_soles_reach_as_low_as_the_collision_boxes() {
        assert!((sole().bounds().0.z + 0.05).abs() < 1e-6);
    }

    #[test]
    fn rest_positions_add_up_along_the_leg() {
        let foot = rest_positions()[Bone::LeftFoot.index()];
        assert!((foot - vec3(0.0, 0.084_887, -0.831_416)).length() < 1e-5);
    }
}
