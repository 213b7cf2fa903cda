//! Version 1 of the pack format: always the humanoid, whose bodies and joints it names in their order.

use alloc::string::{String, ToString};
use alloc::vec::Vec;

use serde::Deserialize;

use crate::excerpt::excerpt;
use crate::format::{
    BodyEntry, DISCRIMINATOR_LAYOUT, DiscriminatorEntry, EdgeEntry, EndEntry, JointEntry, Manifest,
    OBSERVATION_LAYOUT, PACK_VERSION, PathEntry, PolicyEntry, RolesEntry, SkeletonEntry, SkillEntry, Storage,
};
use crate::pack_error::PackError;
use crate::skeleton::Skeleton;

/// Version that this module reads.
pub(crate) const VERSION: u32 = 1;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ManifestOne {
    format: String,
    #[expect(dead_code, reason = "it was read before")]
    version: u32,
    character: String,
    control_hz: f32,
    observation: String,
    discriminator: String,
    bodies: Vec<String>,
    joints: Vec<String>,
    action_centre: Vec<f32>,
    action_gain: Vec<f32>,
    policies: Vec<PolicyEntry>,
    #[serde(default)]
    edges: Vec<EdgeEntry>,
    #[serde(default)]
    paths: Vec<PathEntry>,
    #[serde(default)]
    discriminators: Vec<DiscriminatorOne>,
    #[serde(default)]
    skills: Vec<SkillOne>,
    #[serde(default)]
    recovery: Option<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct DiscriminatorOne {
    name: String,
    layers: Vec<usize>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SkillOne {
    name: String,
    policy: String,
    #[serde(default)]
    entry: Vec<String>,
    returns_to: String,
    #[serde(default)]
    discriminator: Option<String>,
    end: EndOne,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct EndOne {
    threshold: f32,
    hysteresis: f32,
    ticks: u32,
    minimum_seconds: f32,
    limit_seconds: f32,
    #[serde(default)]
    minimum_height: f32,
}

impl ManifestOne {
    /// The same manifest in the present version.
    pub(crate) fn upgraded(self) -> Result<Manifest, PackError> {
        let skeleton = skeleton_entry(&Skeleton::humanoid());
        let names = |names: &mut dyn Iterator<Item = &String>| names.cloned().collect::<Vec<_>>().join(" ");
        let bodies = names(&mut skeleton.bodies.iter().map(|b| &b.name));
        let joints = names(&mut skeleton.joints.iter().map(|j| &j.name));
        let fields = [
            ("observation", "heading-223+target-2".to_string(), &self.observation),
            ("discriminator", "heading-125x5:0,1,2,4,8".to_string(), &self.discriminator),
            ("bodies", bodies, &self.bodies.join(" ")),
            ("joints", joints, &self.joints.join(" ")),
        ];
        if let Some((field, expected, found)) =
            fields.into_iter().find(|(_, expected, found)| expected != *found)
        {
            return Err(PackError::Field { field, expected, found: excerpt(found) });
        }
        let control_hz = self.control_hz;
        Ok(Manifest {
            format: self.format,
            version: PACK_VERSION,
            checksum: None,
            character: self.character,
            control_hz,
            observation: OBSERVATION_LAYOUT.into(),
            discriminator: DISCRIMINATOR_LAYOUT.into(),
            skeleton,
            actuation: None,
            action_centre: self.action_centre,
            action_gain: self.action_gain,
            policies: self.policies,
            edges: self.edges,
            paths: self.paths,
            discriminators: self.discriminators.into_iter().map(DiscriminatorOne::upgraded).collect(),
            skills: self.skills.into_iter().map(|s| s.upgraded(control_hz)).collect(),
            recovery: self.recovery,
            credits: Vec::new(),
            mjcf: None,
        })
    }
}

impl DiscriminatorOne {
    fn upgraded(self) -> DiscriminatorEntry {
        DiscriminatorEntry { name: self.name, layers: self.layers, storage: Storage::F32 }
    }
}

impl SkillOne {
    fn upgraded(self, control_hz: f32) -> SkillEntry {
        let end = EndEntry {
            threshold: self.end.threshold,
            hysteresis: self.end.hysteresis,
            hold_seconds: self.end.ticks as f32 / control_hz,
            minimum_seconds: self.end.minimum_seconds,
            limit_seconds: self.end.limit_seconds,
            minimum_height: self.end.minimum_height,
        };
        SkillEntry {
            name: self.name,
            policy: self.policy,
            entry: self.entry,
            minimum_speed_mps: 0.0,
            maximum_speed_mps: None,
            on_footfall: false,
            in_stride: Vec::new(),
            clock_seconds: None,
            returns_to: self.returns_to,
            discriminator: self.discriminator,
            end,
        }
    }
}

/// A skeleton by names.
fn skeleton_entry(skeleton: &Skeleton) -> SkeletonEntry {
    let name = |id| skeleton.body(id).name.clone();
    let body =
        |b: &crate::skeleton::SkeletonBody| BodyEntry { name: b.name.clone(), parent: b.parent.map(name) };
    let joint = |j: &crate::skeleton::SkeletonJoint| JointEntry {
        name: j.name.clone(),
        body: name(j.body),
        axis: j.axis.to_array(),
        range: j.range,
    };
    let names = |ids: &[crate::BodyId]| ids.iter().map(|id| name(*id)).collect();
    SkeletonEntry {
        bodies: skeleton.bodies().iter().map(body).collect(),
        joints: skeleton.joints().iter().map(joint).collect(),
        roles: RolesEntry {
            head: skeleton.head().map(name),
            hands: names(skeleton.hands()),
            feet: names(skeleton.feet()),
        },
    }
}

impl From<&Skeleton> for SkeletonEntry {
    fn from(skeleton: &Skeleton) -> Self {
        skeleton_entry(skeleton)
    }
}
