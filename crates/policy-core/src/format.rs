//! The description of a character, by names: what a pack's JSON says. [`CharacterPack`](crate::CharacterPack)
//! is its checked form. Specified in `docs/pack-format.md`.

use alloc::string::String;
use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use crate::actuation::ActuationContract;

/// Name of the format, first field of every manifest.
pub const PACK_FORMAT: &str = "policy-space character pack";

/// Version of the format that this library writes. It reads version 1 too.
pub const PACK_VERSION: u32 = 2;

/// Layout of the observation that this library computes, for any skeleton.
pub const OBSERVATION_LAYOUT: &str = "heading-frame+target-2";

/// Layout of the discriminator's input that this library computes, for any skeleton.
pub const DISCRIMINATOR_LAYOUT: &str = "heading-frame:0,1,2,4,8";

/// Longest name of anything in a pack, bytes.
pub const MAX_NAME_BYTES: usize = 64;

/// Largest pack that is worth reading into memory, bytes.
pub const MAX_PACK_BYTES: usize = 256 << 20;

/// Longest header of a pack's file, bytes: manifest, names and shapes of the tensors.
pub const MAX_HEADER_BYTES: usize = 8 << 20;

/// Everything in a pack but the tensors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// [`PACK_FORMAT`].
    pub format: String,
    /// [`PACK_VERSION`].
    pub version: u32,
    /// CRC-32 of the whole file with these eight hexadecimal digits as zeros; filled in when a pack is written.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub checksum: Option<String>,
    /// Name of the character.
    pub character: String,
    /// Control ticks per second the policies were trained at.
    pub control_hz: f32,
    /// [`OBSERVATION_LAYOUT`].
    pub observation: String,
    /// [`DISCRIMINATOR_LAYOUT`].
    pub discriminator: String,
    /// Bodies, joints and roles.
    pub skeleton: SkeletonEntry,
    /// How the motors were driven in training.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub actuation: Option<ActuationContract>,
    /// Centre of each joint's target, radians.
    pub action_centre: Vec<f32>,
    /// Radians of target per unit of action, each joint.
    pub action_gain: Vec<f32>,
    /// The policies, in the order of the graph's nodes.
    pub policies: Vec<PolicyEntry>,
    /// Edges of the graph.
    #[serde(default)]
    pub edges: Vec<EdgeEntry>,
    /// Paths of the graph.
    #[serde(default)]
    pub paths: Vec<PathEntry>,
    /// Discriminators that end skills.
    #[serde(default)]
    pub discriminators: Vec<DiscriminatorEntry>,
    /// Skills that run by policy switch until they end.
    #[serde(default)]
    pub skills: Vec<SkillEntry>,
    /// Name of the skill that brings a fallen character back to its feet.
    #[serde(default)]
    pub recovery: Option<String>,
    /// Where the motion comes from and under which licence.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub credits: Vec<CreditEntry>,
    /// The body as MJCF text.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mjcf: Option<String>,
}

/// A skeleton by names.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SkeletonEntry {
    /// Bodies, the root first, each parent before its children.
    pub bodies: Vec<BodyEntry>,
    /// Hinges in the order of actions.
    pub joints: Vec<JointEntry>,
    /// What some bodies are for.
    #[serde(default)]
    pub roles: RolesEntry,
}

/// A body.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodyEntry {
    /// Unique name.
    pub name: String,
    /// Name of the body it hangs on; none for the root.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub parent: Option<String>,
}

/// A hinge.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointEntry {
    /// Unique name.
    pub name: String,
    /// Name of the body that it moves.
    pub body: String,
    /// Axis in the frame of that body.
    pub axis: [f32; 3],
    /// Least and greatest angle, radians.
    pub range: [f32; 2],
}

/// Bodies by what they are for.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RolesEntry {
    /// Name of the head.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub head: Option<String>,
    /// Names of the hands.
    #[serde(default)]
    pub hands: Vec<String>,
    /// Names of the feet.
    #[serde(default)]
    pub feet: Vec<String>,
}

/// Source of a clip.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CreditEntry {
    /// What it is: a clip's name, say.
    pub work: String,
    /// Who made it, or where it comes from.
    pub source: String,
    /// Its licence.
    pub licence: String,
}

/// Type of the numbers of a network in the file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Storage {
    /// Four bytes each.
    #[default]
    F32,
    /// Two bytes each: rounded to 11 bits when written.
    F16,
}

/// A policy. The default has neither name nor layers, and no variants: something to fill in.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PolicyEntry {
    /// Unique name.
    pub name: String,
    /// Widths: inputs, hidden layers, outputs.
    pub layers: Vec<usize>,
    /// See [`Node::fall_height`](crate::training::Node::fall_height).
    #[serde(default)]
    pub fall_height: Option<f32>,
    /// See [`Node::speed_mps`](crate::training::Node::speed_mps).
    #[serde(default)]
    pub speed_mps: Option<f32>,
    /// See [`Node::strafes`](crate::training::Node::strafes).
    #[serde(default, skip_serializing_if = "is_false")]
    pub strafes: bool,
    /// Name of its variant for rough ground; see [`Node::rough_ground`](crate::training::Node::rough_ground).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rough_ground: Option<String>,
    /// Name of its agile variant; see [`Node::agile`](crate::training::Node::agile).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub agile: Option<String>,
    /// Name of its steady variant; see [`Node::steady`](crate::training::Node::steady).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub steady: Option<String>,
    /// Name of its resting variant; see [`Node::resting`](crate::training::Node::resting).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub resting: Option<String>,
    /// Name of its starting variant; see [`Node::starting`](crate::training::Node::starting).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub starting: Option<String>,
    /// Name of its stopping variant; see [`Node::stopping`](crate::training::Node::stopping).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stopping: Option<String>,
    /// Name of its turning variant; see [`Node::turning`](crate::training::Node::turning).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub turning: Option<String>,
    /// Name of its catching variant; see [`Node::catching`](crate::training::Node::catching).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub catching: Option<String>,
    /// Name of its rising variant; see [`Node::rising`](crate::training::Node::rising).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rising: Option<String>,
    /// Where the policy comes from: recipe, samples, seed.
    #[serde(default)]
    pub origin: String,
}

/// An edge.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EdgeEntry {
    /// Names of the two policies.
    pub nodes: [String; 2],
    /// Seconds from the first to the second.
    pub seconds: f32,
    /// Seconds from the second to the first; none: the same.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seconds_back: Option<f32>,
    /// True for an edge that is crossed and not rested on.
    #[serde(default, skip_serializing_if = "is_false")]
    pub transit: bool,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "as serde calls it")]
fn is_false(value: &bool) -> bool {
    !value
}

/// A path.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PathEntry {
    /// Unique name.
    pub name: String,
    /// Names of its policies, in order.
    pub nodes: Vec<String>,
}

/// A discriminator.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DiscriminatorEntry {
    /// Unique name; that of the skill whose motion it knows.
    pub name: String,
    /// Widths: inputs, hidden layers, 1.
    pub layers: Vec<usize>,
    /// Type of its numbers in the file.
    #[serde(default)]
    pub storage: Storage,
}

/// An episodic skill.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SkillEntry {
    /// Unique name.
    pub name: String,
    /// Name of the policy that runs.
    pub policy: String,
    /// Names of the policies from which it may start; empty: from any.
    #[serde(default)]
    pub entry: Vec<String>,
    /// Speed below which it does not start, metres per second.
    #[serde(default)]
    pub minimum_speed_mps: f32,
    /// Speed above which it does not start, metres per second; `None` for no such condition.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub maximum_speed_mps: Option<f32>,
    /// True for a skill that starts as a foot comes down, while the character goes straight ahead.
    #[serde(default, skip_serializing_if = "is_false")]
    pub on_footfall: bool,
    /// Names of skills that act in its place in the stride of a gait, at most 8: the first that may start. Each has a `minimum_speed_mps`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub in_stride: Vec<String>,
    /// Seconds of the clock that the policy sees in place of the target; `None` for a policy that sees the target.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clock_seconds: Option<f32>,
    /// Name of the policy that runs afterwards.
    pub returns_to: String,
    /// Name of the discriminator that ends it; none: the time limit alone does.
    #[serde(default)]
    pub discriminator: Option<String>,
    /// When it ends.
    pub end: EndEntry,
}

/// See [`EndCondition`](crate::training::EndCondition).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EndEntry {
    /// Score at which the time starts to count, in [0, 1]. With 0 any score will do, so that height alone ends the skill.
    pub threshold: f32,
    /// How far below the threshold the score may fall meanwhile.
    pub hysteresis: f32,
    /// Seconds that the score must hold.
    pub hold_seconds: f32,
    /// Seconds before which the skill does not end.
    pub minimum_seconds: f32,
    /// Seconds after which it ends in any case.
    pub limit_seconds: f32,
    /// Height of the root above the ground below which no score counts, metres.
    #[serde(default)]
    pub minimum_height: f32,
}
