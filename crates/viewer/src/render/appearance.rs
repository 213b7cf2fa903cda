//! How the characters of one skeleton look: their mesh, where there is one, and the dark patches on the ground below
//! them.

use glam::Vec3;
use policy_core::{BodyId, Skeleton};

use crate::mesh::SkinnedMesh;

/// A dark patch on the ground below a body, where light can't reach. It fades as the body rises.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ContactPatch {
    pub(super) body: BodyId,
    /// Above its middle, in the frame of the body, metres.
    pub(super) middle: Vec3,
    /// Along and across the x axis of the body, metres.
    pub(super) half_length: f32,
    pub(super) half_width: f32,
    /// Height at which it vanishes, metres.
    pub(super) vanish: f32,
    /// From 0 to 1, on the ground.
    pub(super) darkness: f32,
}

/// Body, height of its middle in the frame of the body and how far that is in front, half length, half width, height
/// at which it vanishes, darkness.
type Row = (&'static str, [f32; 2], f32, f32, f32, f32);

/// Patches of bodies that are called so: sharp ones below hands and feet, wide ones below the trunk.
const NAMED: [Row; 11] = [
    ("right_foot", [-0.04, 0.045], 0.17, 0.105, 0.22, 0.75),
    ("left_foot", [-0.04, 0.045], 0.17, 0.105, 0.22, 0.75),
    ("right_hand", [-0.03, 0.0], 0.10, 0.10, 0.22, 0.5),
    ("left_hand", [-0.03, 0.0], 0.10, 0.10, 0.22, 0.5),
    ("right_shin", [-0.1, 0.0], 0.2, 0.2, 0.40, 0.45),
    ("left_shin", [-0.1, 0.0], 0.2, 0.2, 0.40, 0.45),
    ("right_lower_arm", [-0.1, 0.0], 0.17, 0.17, 0.35, 0.4),
    ("left_lower_arm", [-0.1, 0.0], 0.17, 0.17, 0.35, 0.4),
    ("head", [0.15, 0.0], 0.22, 0.22, 0.45, 0.55),
    ("torso", [0.1, 0.0], 0.36, 0.36, 0.7, 0.65),
    ("pelvis", [0.05, 0.0], 0.36, 0.36, 0.7, 0.65),
];
/// The patch of any other body.
const OTHER: Row = ("", [0.0, 0.0], 0.14, 0.14, 0.3, 0.45);
/// One more patch below the root: the wide shade of the whole character.
const WHOLE: Row = ("", [0.05, 0.0], 0.7, 0.7, 1.9, 0.30);

/// How characters are drawn.
#[derive(Clone, Debug)]
pub struct Appearance {
    pub(super) mesh: Option<SkinnedMesh>,
    pub(super) patches: Vec<ContactPatch>,
}

impl Appearance {
    /// Characters of `skeleton`. Without a mesh only their collision shapes can be drawn, which the scene brings.
    #[must_use]
    pub fn new(skeleton: &Skeleton, mesh: Option<SkinnedMesh>) -> Self {
        let patch = |body: BodyId, (_, [up, ahead], half_length, half_width, vanish, darkness): Row| {
            let middle = Vec3::new(ahead, 0.0, up);
            ContactPatch { body, middle, half_length, half_width, vanish, darkness }
        };
        let named = |name: &str| NAMED.into_iter().find(|row| row.0 == name).unwrap_or(OTHER);
        let bodies = skeleton.bodies().iter().enumerate();
        let mut patches: Vec<ContactPatch> =
            bodies.map(|(index, body)| patch(BodyId::new(index), named(&body.name))).collect();
        patches.push(patch(skeleton.root(), WHOLE));
        Self { mesh, patches }
    }

    /// The mesh, where there is one.
    #[must_use]
    pub fn mesh(&self) -> Option<&SkinnedMesh> {
        self.mesh.as_ref()
    }
}
