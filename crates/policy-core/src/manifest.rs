//! The description of a character, by names: what a pack's JSON says. [`CharacterPack`](crate::CharacterPack)
//! is its checked form.

use alloc::string::String;
use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

/// Name of the format, first field of every manifest.
pub const PACK_FORMAT: &str = "policy-space character pack";

/// Version of the format that this library reads and writes.
pub const PACK_VERSION: u32 = 1;

/// Layout of the observation that this library computes.
pub const OBSERVATION_LAYOUT: &str = "heading-223+target-2";

/// Layout of the discriminator's input that this library computes.
pub const DISCRIMINATOR_LAYOUT: &str = "heading-125x5:0,1,2,4,8";

/// Everything in a pack but the tensors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// [`PACK_FORMAT`].
    pub format: String,
    /// [`PACK_VERSION`].
    pub version: u32,
    /// Name of the character.
    pub character: String,
    /// Control ticks per second the policies were trained at.
    pub control_hz: f32,
    /// [`OBSERVATION_LAYOUT`].
    pub observation: String,
    /// [`DISCRIMINATOR_LAYOUT`].
    pub discriminator: String,
    /// [`BODY_NAMES`](crate::BODY_NAMES).
    pub bodies: Vec<String>,
    /// [`JOINT_NAMES`](crate::JOINT_NAMES).
    pub joints: Vec<String>,
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
}

/// A policy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PolicyEntry {
    /// Unique name.
    pub name: String,
    /// Widths: inputs, hidden layers, outputs.
    pub layers: Vec<usize>,
    /// See [`Node::fall_height`](crate::Node::fall_height).
    #[serde(default)]
    pub fall_height: Option<f32>,
    /// See [`Node::speed_mps`](crate::Node::speed_mps).
    #[serde(default)]
    pub speed_mps: Option<f32>,
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
    /// Seconds from one end to the other.
    pub seconds: f32,
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
    /// Name of the policy that runs afterwards.
    pub returns_to: String,
    /// Name of the discriminator that ends it; none: the time limit alone does.
    #[serde(default)]
    pub discriminator: Option<String>,
    /// See [`EndCondition`](crate::EndCondition).
    pub end: crate::skill::EndCondition,
}
