//! The bodies of the humanoid that the mannequin is sculpted for, in the order of its skeleton.

/// Number of bodies.
pub(super) const BONE_COUNT: usize = 15;

/// A body of the humanoid; the discriminant is its index in every per-body array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum Bone {
    Pelvis,
    Torso,
    Head,
    RightUpperArm,
    RightLowerArm,
    RightHand,
    LeftUpperArm,
    LeftLowerArm,
    LeftHand,
    RightThigh,
    RightShin,
    RightFoot,
    LeftThigh,
    LeftShin,
    LeftFoot,
}

impl Bone {
    /// All bodies in index order.
    pub(super) const ALL: [Bone; BONE_COUNT] = [
        Bone::Pelvis,
        Bone::Torso,
        Bone::Head,
        Bone::RightUpperArm,
        Bone::RightLowerArm,
        Bone::RightHand,
        Bone::LeftUpperArm,
        Bone::LeftLowerArm,
        Bone::LeftHand,
        Bone::RightThigh,
        Bone::RightShin,
        Bone::RightFoot,
        Bone::LeftThigh,
        Bone::LeftShin,
        Bone::LeftFoot,
    ];

    /// Index in every per-body array, `0..BONE_COUNT`.
    pub(super) const fn index(self) -> usize {
        self as usize
    }

    /// Name in the MJCF and in glTF nodes, such as `right_upper_arm`.
    pub(super) const fn name(self) -> &'static str {
        BONE_NAMES[self as usize]
    }

    /// The body called `name`, if there is one.
    pub(super) fn from_name(name: &str) -> Option<Bone> {
        BONE_NAMES.iter().position(|&n| n == name).map(|i| Self::ALL[i])
    }

    /// The same body of the other side; itself in the middle.
    pub(super) fn mirrored(self) -> Bone {
        let name = self.name();
        let other = match name.strip_prefix("right_") {
            Some(part) => format!("left_{part}"),
            None => name.replacen("left_", "right_", 1),
        };
        Self::from_name(&other).unwrap_or(self)
    }

    /// The body this one hangs on; `None` for the pelvis.
    pub(super) const fn parent(self) -> Option<Bone> {
        match self {
            Bone::Pelvis => None,
            Bone::Torso | Bone::RightThigh | Bone::LeftThigh => Some(Bone::Pelvis),
            Bone::Head | Bone::RightUpperArm | Bone::LeftUpperArm => Some(Bone::Torso),
            Bone::RightLowerArm => Some(Bone::RightUpperArm),
            Bone::RightHand => Some(Bone::RightLowerArm),
            Bone::LeftLowerArm => Some(Bone::LeftUpperArm),
            Bone::LeftHand => Some(Bone::LeftLowerArm),
            Bone::RightShin => Some(Bone::RightThigh),
            Bone::RightFoot => Some(Bone::RightShin),
            Bone::LeftShin => Some(Bone::LeftThigh),
            Bone::LeftFoot => Some(Bone::LeftShin),
        }
    }
}

/// Names of the bodies in index order.
pub(super) const BONE_NAMES: [&str; BONE_COUNT] = [
    "pelvis",
    "torso",
    "head",
    "right_upper_arm",
    "right_lower_arm",
    "right_hand",
    "left_upper_arm",
    "left_lower_arm",
    "left_hand",
    "right_thigh",
    "right_shin",
    "right_foot",
    "left_thigh",
    "left_shin",
    "left_foot",
];
