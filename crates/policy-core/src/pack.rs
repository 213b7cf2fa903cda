//! The character pack: everything that a character needs at run time, checked and immutable.

use alloc::string::String;
use alloc::sync::Arc;
use alloc::vec::Vec;

use crate::action::ActionScaling;
use crate::actuation::ActuationContract;
use crate::format::{CreditEntry, Manifest};
use crate::graph::{Node, PolicyGraph};
use crate::ids::{PolicyId, SkillId};
use crate::mlp::Mlp;
use crate::normaliser::Normaliser;
use crate::pack_error::PackError;
use crate::pack_parts::{
    action_scaling, check_manifest, check_networks, check_reachable, edge, find, find_node, skeleton, skill,
};
use crate::skeleton::Skeleton;
use crate::skill::Skill;

/// The numbers of a pack; the manifest says what they are.
#[derive(Clone, Debug, PartialEq)]
pub struct PackTensors {
    /// One network for each policy of the manifest, all of one shape: from [`Skeleton::policy_input_len`] inputs to one
    /// output for each joint.
    pub policies: Vec<Mlp>,
    /// One network for each discriminator of the manifest: [`Skeleton::discriminator_input_len`] inputs, 1 output (a
    /// logit).
    pub discriminators: Vec<Mlp>,
    /// Of the observation: [`Skeleton::observation_len`] numbers.
    pub observation_normaliser: Normaliser,
    /// Of the features of one frame: [`Skeleton::frame_len`] numbers.
    pub discriminator_normaliser: Normaliser,
    /// The skinned mesh, a binary glTF file. Its nodes are named like the bodies. Not checked here.
    pub mesh: Option<Vec<u8>>,
}

/// Every policy, discriminator and skill of one character, the graph that joins them, and its body.
///
/// Immutable: share one pack between all characters (`Arc`). [`CharacterPack::from_bytes`] reads one.
#[derive(Clone, Debug)]
pub struct CharacterPack {
    manifest: Manifest,
    tensors: PackTensors,
    skeleton: Arc<Skeleton>,
    graph: PolicyGraph,
    skills: Vec<Skill>,
    recovery: Option<SkillId>,
    action: ActionScaling,
}

impl CharacterPack {
    /// A pack of a manifest and its tensors. A checksum in the manifest is dropped: it belongs to the bytes of a file.
    ///
    /// # Errors
    /// When anything is not as the manifest or this library says; see [`PackError`].
    pub fn from_parts(mut manifest: Manifest, tensors: PackTensors) -> Result<Self, PackError> {
        manifest.checksum = None;
        check_manifest(&manifest)?;
        let skeleton = skeleton(&manifest.skeleton)?;
        check_networks(&manifest, &tensors, &skeleton)?;
        let names: Vec<&str> = manifest.policies.iter().map(|p| p.name.as_str()).collect();
        let nodes = manifest.policies.iter().map(|p| {
            let field = || alloc::format!("policy \"{}\"", p.name);
            let variant = |name: &Option<String>| {
                name.as_ref().map(|name| find_node(field(), name, &names)).transpose()
            };
            Ok(Node {
                name: p.name.clone(),
                fall_height: p.fall_height,
                speed_mps: p.speed_mps,
                strafes: p.strafes,
                rough_ground: variant(&p.rough_ground)?,
                agile: variant(&p.agile)?,
                steady: variant(&p.steady)?,
                resting: variant(&p.resting)?,
                starting: variant(&p.starting)?,
                stopping: variant(&p.stopping)?,
                turning: variant(&p.turning)?,
                catching: variant(&p.catching)?,
                rising: variant(&p.rising)?,
            })
        });
        let nodes = nodes.collect::<Result<Vec<_>, PackError>>()?;
        let edges = manifest.edges.iter().map(|e| edge(e, &names)).collect::<Result<Vec<_>, _>>()?;
        let paths = manifest.paths.iter().map(|path| {
            let field = || alloc::format!("path \"{}\"", path.name);
            let nodes = path.nodes.iter().map(|n| find_node(field(), n, &names)).collect::<Result<_, _>>()?;
            Ok((path.name.clone(), nodes))
        });
        let paths = paths.collect::<Result<Vec<_>, PackError>>()?;
        let skills =
            manifest.skills.iter().map(|s| skill(s, &names, &manifest)).collect::<Result<Vec<_>, _>>()?;
        let mut skill_names = manifest.skills.iter().map(|s| s.name.as_str());
        let recovery = match &manifest.recovery {
            None => None,
            Some(name) => Some(SkillId::new(find("skill", "recovery", name, &mut skill_names)?)),
        };
        let action = action_scaling(&manifest, &skeleton)?;
        let graph = PolicyGraph::from_parts(nodes, &edges, paths, &tensors.policies)?;
        check_reachable(&graph, &skills)?;
        Ok(Self { manifest, tensors, skeleton: Arc::new(skeleton), graph, skills, recovery, action })
    }

    /// The same pack with the checksum of its file, which was compared with the bytes.
    pub(crate) fn with_checksum(mut self, checksum: Option<String>) -> Self {
        self.manifest.checksum = checksum;
        self
    }

    /// The description the pack was made of.
    #[must_use]
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// All numbers of the pack.
    #[must_use]
    pub fn tensors(&self) -> &PackTensors {
        &self.tensors
    }

    /// Policies, one for each node of the graph.
    #[must_use]
    pub fn policies(&self) -> &[Mlp] {
        &self.tensors.policies
    }

    /// The policy graph.
    #[must_use]
    pub fn graph(&self) -> &PolicyGraph {
        &self.graph
    }

    /// Episodic skills.
    #[must_use]
    pub fn skills(&self) -> &[Skill] {
        &self.skills
    }

    /// The skill called `name`.
    #[must_use]
    pub fn skill_named(&self, name: &str) -> Option<SkillId> {
        self.skills.iter().position(|s| s.name == name).map(SkillId::new)
    }

    /// The policy called `name`.
    #[must_use]
    pub fn policy_named(&self, name: &str) -> Option<PolicyId> {
        self.graph.node_named(name).map(PolicyId::from)
    }

    /// The skill that brings a fallen character to its feet.
    #[must_use]
    pub fn recovery(&self) -> Option<SkillId> {
        self.recovery
    }

    /// Bodies and joints.
    #[must_use]
    pub fn skeleton(&self) -> &Arc<Skeleton> {
        &self.skeleton
    }

    /// Control ticks per second that the policies were trained at, in [1, 1000].
    #[must_use]
    pub fn control_hz(&self) -> f32 {
        self.manifest.control_hz
    }

    /// How the motors were driven in training. Packs of version 1 don't say.
    #[must_use]
    pub fn actuation(&self) -> Option<&ActuationContract> {
        self.manifest.actuation.as_ref()
    }

    /// The body as MJCF text. Packs of version 1 have none.
    #[must_use]
    pub fn mjcf(&self) -> Option<&str> {
        self.manifest.mjcf.as_deref()
    }

    /// The skinned mesh, a binary glTF file.
    #[must_use]
    pub fn mesh(&self) -> Option<&[u8]> {
        self.tensors.mesh.as_deref()
    }

    /// Where the motion comes from and under which licence.
    #[must_use]
    pub fn credits(&self) -> &[CreditEntry] {
        &self.manifest.credits
    }

    /// True for a pack that was read from a file with a checksum, which was right. A file without one is read too.
    #[must_use]
    pub fn is_verified(&self) -> bool {
        self.manifest.checksum.is_some()
    }

    /// How actions become joint targets.
    #[must_use]
    pub fn action(&self) -> &ActionScaling {
        &self.action
    }
}
