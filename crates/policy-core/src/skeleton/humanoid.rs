//! The humanoid of AMP and ASE, 15 bodies and 28 hinges. Version-1 packs are all for it and do not describe it.

use alloc::vec::Vec;

use glam::Vec3;

use super::{Roles, Skeleton, SkeletonBody, SkeletonJoint};
use crate::ids::BodyId;

/// Name of each body and index of its parent; the root names itself.
const BODIES: [(&str, usize); 15] = [
    ("pelvis", 0),
    ("torso", 0),
    ("head", 1),
    ("right_upper_arm", 1),
    ("right_lower_arm", 3),
    ("right_hand", 4),
    ("left_upper_arm", 1),
    ("left_lower_arm", 6),
    ("left_hand", 7),
    ("right_thigh", 0),
    ("right_shin", 9),
    ("right_foot", 10),
    ("left_thigh", 0),
    ("left_shin", 12),
    ("left_foot", 13),
];

/// Name of each hinge, index of its body, axis and range in degrees.
const JOINTS: [(&str, usize, Vec3, [f32; 2]); 28] = [
    ("abdomen_x", 1, Vec3::X, [-60.0, 60.0]),
    ("abdomen_y", 1, Vec3::Y, [-60.0, 90.0]),
    ("abdomen_z", 1, Vec3::Z, [-50.0, 50.0]),
    ("neck_x", 2, Vec3::X, [-50.0, 50.0]),
    ("neck_y", 2, Vec3::Y, [-40.0, 60.0]),
    ("neck_z", 2, Vec3::Z, [-45.0, 45.0]),
    ("right_shoulder_y", 3, Vec3::Y, [-180.0, 60.0]),
    ("right_shoulder_x", 3, Vec3::X, [-180.0, 45.0]),
    ("right_shoulder_z", 3, Vec3::Z, [-90.0, 90.0]),
    ("right_elbow", 4, Vec3::Y, [-160.0, 0.0]),
    ("left_shoulder_y", 6, Vec3::Y, [-180.0, 60.0]),
    ("left_shoulder_x", 6, Vec3::X, [-45.0, 180.0]),
    ("left_shoulder_z", 6, Vec3::Z, [-90.0, 90.0]),
    ("left_elbow", 7, Vec3::Y, [-160.0, 0.0]),
    ("right_hip_y", 9, Vec3::Y, [-140.0, 60.0]),
    ("right_hip_x", 9, Vec3::X, [-60.0, 15.0]),
    ("right_hip_z", 9, Vec3::Z, [-60.0, 35.0]),
    ("right_knee", 10, Vec3::Y, [0.0, 160.0]),
    ("right_ankle_x", 11, Vec3::X, [-30.0, 30.0]),
    ("right_ankle_y", 11, Vec3::Y, [-55.0, 55.0]),
    ("right_ankle_z", 11, Vec3::Z, [-40.0, 40.0]),
    ("left_hip_y", 12, Vec3::Y, [-140.0, 60.0]),
    ("left_hip_x", 12, Vec3::X, [-15.0, 60.0]),
    ("left_hip_z", 12, Vec3::Z, [-35.0, 60.0]),
    ("left_knee", 13, Vec3::Y, [0.0, 160.0]),
    ("left_ankle_x", 14, Vec3::X, [-30.0, 30.0]),
    ("left_ankle_y", 14, Vec3::Y, [-55.0, 55.0]),
    ("left_ankle_z", 14, Vec3::Z, [-40.0, 40.0]),
];

const HEAD: usize = 2;
const HANDS: [usize; 2] = [5, 8];
const FEET: [usize; 2] = [11, 14];

impl Skeleton {
    /// The skeleton of version-1 packs: the humanoid of AMP and ASE, ranges as in its MJCF.
    #[must_use]
    pub fn humanoid() -> Self {
        let bodies = BODIES.iter().enumerate().map(|(index, (name, parent))| SkeletonBody {
            name: (*name).into(),
            parent: (index > 0).then(|| BodyId::new(*parent)),
        });
        let joints = JOINTS.iter().map(|(name, body, axis, range)| SkeletonJoint {
            name: (*name).into(),
            body: BodyId::new(*body),
            axis: *axis,
            range: range.map(f32::to_radians),
        });
        let ids = |indices: [usize; 2]| indices.map(BodyId::new).to_vec();
        let roles = Roles { head: Some(BodyId::new(HEAD)), hands: ids(HANDS), feet: ids(FEET) };
        let (bodies, joints): (Vec<_>, Vec<_>) = (bodies.collect(), joints.collect());
        Self::from_parts(bodies, joints, roles).expect("the tables above hold a valid skeleton")
    }
}
