//! What a pack is to hold, as a file has it.

use std::path::Path;

use policy_core::format::{CreditEntry, EdgeEntry, PathEntry, SkillEntry};
use serde::Deserialize;

use super::BindError;
use crate::toml_file;

/// What a pack is to hold: nodes, edges, paths and skills by name. A TOML file.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PackPlan {
    /// Name of the character.
    pub character: String,
    /// Run in which policies of this pack were trained together; they come from there where it exists.
    #[serde(default)]
    pub joint: Option<String>,
    /// Skill that brings a fallen character to its feet.
    #[serde(default)]
    pub recovery: Option<String>,
    /// Nodes of the graph.
    pub policies: Vec<PlannedPolicy>,
    /// Its edges.
    #[serde(default)]
    pub edges: Vec<EdgeEntry>,
    /// Its paths.
    #[serde(default)]
    pub paths: Vec<PathEntry>,
    /// Its episodic skills.
    #[serde(default)]
    pub skills: Vec<SkillEntry>,
    /// Where the clips come from and under which licences.
    #[serde(default)]
    pub credits: Vec<CreditEntry>,
}

/// A node of the graph.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlannedPolicy {
    /// Name of the skill that was trained.
    pub name: String,
    /// Run, or kept checkpoint, that it comes from; without it the joint run, or the skill's own.
    #[serde(default)]
    pub from: Option<String>,
    /// Root height below which the character has fallen, metres.
    #[serde(default)]
    pub fall_height: Option<f32>,
    /// Speed at which it goes straight ahead, metres per second.
    #[serde(default)]
    pub speed_mps: Option<f32>,
    /// True for a policy that faces one way and moves another.
    #[serde(default)]
    pub strafes: bool,
    /// Skill of the run that the policy is of, where that is not its name.
    #[serde(default)]
    pub skill: Option<String>,
    /// Name of its variant for rough ground.
    #[serde(default)]
    pub rough_ground: Option<String>,
    /// Name of its agile variant.
    #[serde(default)]
    pub agile: Option<String>,
    /// Name of its steady variant.
    #[serde(default)]
    pub steady: Option<String>,
    /// Name of its resting variant.
    #[serde(default)]
    pub resting: Option<String>,
    /// Name of its starting variant.
    #[serde(default)]
    pub starting: Option<String>,
    /// Name of its stopping variant.
    #[serde(default)]
    pub stopping: Option<String>,
    /// Name of its turning variant.
    #[serde(default)]
    pub turning: Option<String>,
    /// Name of its catching variant.
    #[serde(default)]
    pub catching: Option<String>,
    /// Name of its rising variant.
    #[serde(default)]
    pub rising: Option<String>,
}

impl PackPlan {
    /// Reads a plan.
    ///
    /// # Errors
    /// When the file can't be read, or has unknown or missing fields.
    pub fn load(path: &Path) -> Result<Self, BindError> {
        Ok(toml_file::parse(path, &toml_file::read_text(path)?)?)
    }

    /// The plan without skills that `trained` refuses: their nodes, edges and episodic skills go, paths close over
    /// the gap while an edge still joins what remains, and paths of a single node go.
    #[must_use]
    pub fn only(mut self, trained: impl Fn(&str) -> bool) -> Self {
        self.policies.retain(|p| trained(&p.name));
        for policy in &mut self.policies {
            let PlannedPolicy {
                rough_ground,
                agile,
                steady,
                resting,
                starting,
                stopping,
                turning,
                catching,
                rising,
                ..
            } = policy;
            for variant in
                [rough_ground, agile, steady, resting, starting, stopping, turning, catching, rising]
            {
                *variant = variant.take().filter(|name| trained(name));
            }
        }
        self.edges.retain(|e| e.nodes.iter().all(|n| trained(n)));
        let edges = self.edges.clone();
        let joined = |a: &str, b: &str| {
            edges.iter().any(|e| e.nodes.iter().any(|n| n == a) && e.nodes.iter().any(|n| n == b))
        };
        for path in &mut self.paths {
            let mut kept: Vec<String> = Vec::new();
            for node in path.nodes.drain(..).filter(|n| trained(n)) {
                match kept.last() {
                    Some(last) if !joined(last, &node) => break,
                    _ => kept.push(node),
                }
            }
            path.nodes = kept;
        }
        self.paths.retain(|p| p.nodes.len() > 1);
        self.skills.retain(|s| trained(&s.policy) && trained(&s.returns_to));
        for skill in &mut self.skills {
            skill.entry.retain(|n| trained(n));
        }
        let names: Vec<String> = self.skills.iter().map(|skill| skill.name.clone()).collect();
        for skill in &mut self.skills {
            skill.in_stride.retain(|name| names.contains(name));
        }
        self.recovery = self.recovery.filter(|r| self.skills.iter().any(|s| s.name == *r));
        self
    }
}
