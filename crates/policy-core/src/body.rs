//! Names and order of the humanoid's bodies and joints: the character of AMP and ASE, 15 bodies and
//! 28 degrees of freedom.
//!
//! Order is part of every observation and action, so it is stated once, here, and every pack is
//! checked against it when it is loaded.

/// Number of bodies, the pelvis included.
pub const BODY_COUNT: usize = 15;

/// Number of actuated degrees of freedom (hinges).
pub const DOF_COUNT: usize = 28;

/// A body of the humanoid; the discriminant is its index in every per-body array.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[repr(u8)]
#[expect(missing_docs, reason = "the names say it all")]
pub enum Body {
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

impl Body {
    /// All bodies in index order.
    pub const ALL: [Body; BODY_COUNT] = [
        Body::Pelvis,
        Body::Torso,
        Body::Head,
        Body::RightUpperArm,
        Body::RightLowerArm,
        Body::RightHand,
        Body::LeftUpperArm,
        Body::LeftLowerArm,
        Body::LeftHand,
        Body::RightThigh,
        Body::RightShin,
        Body::RightFoot,
        Body::LeftThigh,
        Body::LeftShin,
        Body::LeftFoot,
    ];

    /// Index in every per-body array, `0..BODY_COUNT`.
    #[must_use]
    pub const fn index(self) -> usize {
        self as usize
    }

    /// Name in the MJCF, in packs and in glTF nodes, such as `right_upper_arm`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        BODY_NAMES[self as usize]
    }

    /// The body called `name`, if there is one.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Body> {
        BODY_NAMES.iter().position(|&n| n == name).map(|i| Self::ALL[i])
    }

    /// The body this one hangs on; `None` for the pelvis.
    #[must_use]
    pub const fn parent(self) -> Option<Body> {
        match self {
            Body::Pelvis => None,
            Body::Torso | Body::RightThigh | Body::LeftThigh => Some(Body::Pelvis),
            Body::Head | Body::RightUpperArm | Body::LeftUpperArm => Some(Body::Torso),
            Body::RightLowerArm => Some(Body::RightUpperArm),
            Body::RightHand => Some(Body::RightLowerArm),
            Body::LeftLowerArm => Some(Body::LeftUpperArm),
            Body::LeftHand => Some(Body::LeftLowerArm),
            Body::RightShin => Some(Body::RightThigh),
            Body::RightFoot => Some(Body::RightShin),
            Body::LeftShin => Some(Body::LeftThigh),
            Body::LeftFoot => Some(Body::LeftShin),
        }
    }
}

/// Names of the bodies in index order.
pub const BODY_NAMES: [&str; BODY_COUNT] = [
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

/// Names of the actuated joints in the order of actions, joint targets and joint velocities.
pub const JOINT_NAMES: [&str; DOF_COUNT] = [
    "abdomen_x",
    "abdomen_y",
    "abdomen_z",
    "neck_x",
    "neck_y",
    "neck_z",
    "right_shoulder_y",
    "right_shoulder_x",
    "right_shoulder_z",
    "right_elbow",
    "left_shoulder_y",
    "left_shoulder_x",
    "left_shoulder_z",
    "left_elbow",
    "right_hip_y",
    "right_hip_x",
    "right_hip_z",
    "right_knee",
    "right_ankle_x",
    "right_ankle_y",
    "right_ankle_z",
    "left_hip_y",
    "left_hip_x",
    "left_hip_z",
    "left_knee",
    "left_ankle_x",
    "left_ankle_y",
    "left_ankle_z",
];
