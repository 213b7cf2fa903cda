//! What an engine must know beside the models: conventions, layout of the observation, joints, motors, rates.

use policy_core::training::{NORMALISED_LIMIT, TARGET_LEN, TARGET_RANGE_METRES};
use policy_core::{CharacterPack, JointActuation, NodeId, PolicyGraph};
use serde::{Deserialize, Serialize};

use super::{ACTION, BLEND, OBSERVATION, OPSET};

/// Name of the deployment file.
pub const DEPLOYMENT_FILE: &str = "deployment.json";

/// Name of the body's file.
pub(super) const MJCF_FILE: &str = "body.xml";

/// First field of every deployment file.
const FORMAT: &str = "policy-space deployment";

/// Version of the deployment file.
const VERSION: u32 = 1;

/// A deployment file. Fields are in the order in which a reader needs them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Deployment {
    /// What the file is.
    pub format: String,
    /// Its version.
    pub version: u32,
    /// Name of the character.
    pub character: String,
    /// Axes, order of quaternions, units.
    pub conventions: Conventions,
    /// Control and physics.
    pub timing: Timing,
    /// Names of the bodies, in the order of the observation.
    pub bodies: Vec<String>,
    /// Joints, in the order of the action.
    pub joints: Vec<DeployedJoint>,
    /// File of the body as MJCF.
    pub mjcf: Option<String>,
    /// Mass of all bodies, kilograms, where the pack says.
    pub mass_kg: Option<f32>,
    /// The input of every model.
    pub observation: ObservationLayout,
    /// How an action becomes a joint target.
    pub action: String,
    /// Version of the operators.
    pub opset: i64,
    /// One model for each policy.
    pub policies: Vec<PolicyFile>,
    /// One model for each path.
    pub paths: Vec<PathFile>,
}

/// Axes, order of quaternions, units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Conventions {
    /// Handedness and the axis that points up.
    pub world: String,
    /// Order of the numbers of a quaternion.
    pub quaternion: String,
    /// Units.
    pub units: String,
    /// The frame of the observation.
    pub heading_frame: String,
}

/// Control and physics.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Timing {
    /// Control ticks per second.
    pub control_hz: f32,
    /// Physics steps per second in training, where the pack says.
    pub physics_hz: Option<f32>,
}

/// A joint: hinge, action scaling and motor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DeployedJoint {
    /// Its name.
    pub name: String,
    /// Name of the body that it moves.
    pub body: String,
    /// Axis in the frame of that body.
    pub axis: [f32; 3],
    /// Least and greatest angle, radians.
    pub range: [f32; 2],
    /// Joint target of a zero action, radians.
    pub action_centre: f32,
    /// Radians of joint target per unit of action.
    pub action_gain: f32,
    /// The motor, where the pack says: gain, damping, force limit, armature.
    pub motor: Option<JointActuation>,
}

/// The input of every model: raw numbers; the normaliser is inside the model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ObservationLayout {
    /// Name of the input.
    pub input: String,
    /// Numbers for each character.
    pub len: usize,
    /// Its parts, in order.
    pub parts: Vec<ObservationPart>,
    /// Normalised values are clipped to plus and minus this, inside the model.
    pub clip: f32,
}

/// A part of the observation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ObservationPart {
    /// What it is.
    pub name: String,
    /// Index of its first number.
    pub start: usize,
    /// Its numbers.
    pub len: usize,
    /// Unit and order.
    pub description: String,
}

/// The model of a policy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PolicyFile {
    /// Name of the policy.
    pub name: String,
    /// Its file, beside this one.
    pub file: String,
    /// Root height that means a fall, metres.
    pub fall_height: Option<f32>,
    /// Speed that it was trained for, metres per second.
    pub speed_mps: Option<f32>,
    /// True when it faces one way and moves another: the root's x axis in its observation lies in the frame of the way to face.
    #[serde(default)]
    pub strafes: bool,
    /// Of a timed skill: in place of the target its policy sees `2.5 [cos a, sin a]`, where the angle `a` goes from 0 to pi in so many
    /// seconds and stays there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clock_seconds: Option<f32>,
}

/// The model of a path.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PathFile {
    /// Name of the path.
    pub name: String,
    /// Its file, beside this one.
    pub file: String,
    /// Name of the input that holds blend weights.
    pub blend_input: String,
    /// Rows of that input: layers of a policy. A game gives all rows the same weights.
    pub layers: usize,
    /// Columns of that input: the policies, in the order of the path. The weights of a row add up to 1.
    pub nodes: Vec<String>,
    /// Least time from each node to the next and back, seconds.
    pub seconds: Vec<[f32; 2]>,
}

/// Seconds of the clock that a policy sees as that of a timed skill.
fn clock_seconds(pack: &CharacterPack, policy: usize) -> Option<f32> {
    pack.skills().iter().find(|skill| skill.policy.index() == policy)?.clock_seconds
}

impl Deployment {
    /// The deployment file of a pack.
    #[must_use]
    pub fn of(pack: &CharacterPack) -> Self {
        let (graph, skeleton) = (pack.graph(), pack.skeleton());
        let name = |node: &NodeId| graph.node(*node).name.clone();
        let policies = graph.nodes().iter().enumerate().map(|(index, node)| PolicyFile {
            name: node.name.clone(),
            file: file_name("policy", index, &node.name),
            fall_height: node.fall_height,
            speed_mps: node.speed_mps,
            strafes: node.strafes,
            clock_seconds: clock_seconds(pack, index),
        });
        let paths = graph.paths().iter().enumerate().map(|(index, path)| PathFile {
            name: path.name().to_owned(),
            file: file_name("path", index, path.name()),
            blend_input: BLEND.to_owned(),
            // A pack without policies is refused.
            layers: pack.policies()[0].layers().len(),
            nodes: path.nodes().iter().map(name).collect(),
            seconds: path.nodes().windows(2).map(|pair| seconds(graph, pair[0], pair[1])).collect(),
        });
        Self {
            format: FORMAT.to_owned(),
            version: VERSION,
            character: pack.manifest().character.clone(),
            conventions: Conventions::ours(),
            timing: Timing {
                control_hz: pack.control_hz(),
                physics_hz: pack.actuation().map(|a| a.physics_hz),
            },
            bodies: skeleton.bodies().iter().map(|body| body.name.clone()).collect(),
            joints: joints(pack),
            mjcf: pack.mjcf().map(|_| MJCF_FILE.to_owned()),
            mass_kg: pack.actuation().map(|a| a.mass_kg),
            observation: ObservationLayout::of_bodies(skeleton.body_count()),
            action: format!("joint target in radians = action_centre + action_gain * {ACTION}; not clamped"),
            opset: OPSET,
            policies: policies.collect(),
            paths: paths.collect(),
        }
    }

    /// As JSON. Equal deployments give equal bytes.
    #[must_use]
    pub fn to_json(&self) -> String {
        // JSON writes numbers that are not finite as null, and no map here has odd keys.
        let json = serde_json::to_string_pretty(self).expect("strings and finite numbers are JSON");
        json + "\n"
    }

    /// Reads JSON of this format and version.
    ///
    /// # Errors
    /// What was found instead, in words.
    pub fn from_json(json: &str) -> Result<Self, String> {
        let read: Self = serde_json::from_str(json).map_err(|e| files::quoted(&e.to_string()))?;
        if read.format != FORMAT || read.version != VERSION {
            let format = files::quoted(&read.format);
            return Err(format!("format {format:?} of version {}", read.version));
        }
        Ok(read)
    }
}

impl Conventions {
    fn ours() -> Self {
        Self {
            world: "right-handed, z up".to_owned(),
            quaternion: "x, y, z, w; turns body space to world space".to_owned(),
            units: "metres, kilograms, seconds, radians".to_owned(),
            heading_frame: "the world turned about z so that the root's x axis lies in the xz plane"
                .to_owned(),
        }
    }
}

impl ObservationLayout {
    fn of_bodies(count: usize) -> Self {
        // A skeleton has a body at least.
        let described = [
            ("root_height", 1, "height of the root above the ground, m".to_owned()),
            (
                "positions",
                3 * count - 3,
                "of the bodies but the root, relative to the root, those of feet and shins lowered by the rise of the ground that \
                 they come to within 0.1 s and 0.3 s, m"
                    .to_owned(),
            ),
            ("axes", 6 * count, "x axis, then z axis of each body".to_owned()),
            ("linear_velocities", 3 * count, "of the origin of each body's frame, m/s".to_owned()),
            ("angular_velocities", 3 * count, "of each body, rad/s".to_owned()),
            (
                "target",
                TARGET_LEN,
                format!(
                    "direction to the target times min(distance, {TARGET_RANGE_METRES} m) / 2; zero to stand"
                ),
            ),
        ];
        let mut start = 0;
        let parts = described.into_iter().map(|(name, len, description)| {
            let description = format!("{description}; heading frame");
            let part = ObservationPart { name: name.to_owned(), start, len, description };
            start += len;
            part
        });
        let parts = parts.collect();
        Self { input: OBSERVATION.to_owned(), len: start, parts, clip: NORMALISED_LIMIT }
    }
}

/// Time from a node to its neighbour and back.
fn seconds(graph: &PolicyGraph, a: NodeId, b: NodeId) -> [f32; 2] {
    // The graph checked it when the pack was made.
    let edge = graph.edge_between(a, b).expect("a path runs along edges");
    [edge.seconds_from(a), edge.seconds_from(b)]
}

fn joints(pack: &CharacterPack) -> Vec<DeployedJoint> {
    let skeleton = pack.skeleton();
    // A pack has an action scaling and, where it has motors, one for each joint.
    let joints = skeleton.joints().iter().enumerate().map(|(index, joint)| DeployedJoint {
        name: joint.name.clone(),
        body: skeleton.body(joint.body).name.clone(),
        axis: joint.axis.into(),
        range: joint.range,
        action_centre: pack.action().centre()[index],
        action_gain: pack.action().gain()[index],
        motor: pack.actuation().map(|a| a.joints[index]),
    });
    joints.collect()
}

/// A file name that every system takes. Names that had to be changed get their index, so that no two files are one.
fn file_name(kind: &str, index: usize, name: &str) -> String {
    let plain: String =
        name.chars().map(|c| if c.is_ascii_alphanumeric() || c == '_' { c } else { '-' }).collect();
    let changed = plain != name || name.contains(|c: char| c == '-' || c.is_ascii_uppercase());
    if changed { format!("{kind}_{plain}-{index}.onnx") } else { format!("{kind}_{plain}.onnx") }
}
