//! What the tests of this crate share.
#![allow(dead_code, missing_docs, reason = "each test uses its part")]

pub mod shared_world;

use physics_bridge::{Character, Model};
use policy_core::format::{
    DISCRIMINATOR_LAYOUT, EdgeEntry, Manifest, OBSERVATION_LAYOUT, PACK_FORMAT, PACK_VERSION, PathEntry,
    PolicyEntry,
};
use policy_core::training::{ActionScaling, Layer, Normaliser, PackTensors};
use policy_core::{ActuationContract, BodyId, CharacterPack, JointTargets, Mlp, Skeleton};

pub const HUMANOID: &str = include_str!("../../../../assets/humanoid.xml");

/// A trunk, a head and four legs: other bodies, joints, order and rate than the humanoid's.
pub const QUADRUPED: &str = include_str!("../../../../tests/assets/quadruped.xml");

pub fn humanoid() -> Model {
    Model::from_mjcf(HUMANOID).unwrap()
}

pub fn quadruped() -> Model {
    Model::from_mjcf(QUADRUPED).unwrap()
}

pub fn body(model: &Model, name: &str) -> BodyId {
    model.skeleton().body_named(name).unwrap()
}

/// Targets that keep the character moving, different in every tick.
pub fn wriggle_into(tick: u64, targets: &mut [f32]) {
    for (joint, target) in targets.iter_mut().enumerate() {
        *target = 0.4 * (0.3 * tick as f32 + joint as f32).sin();
    }
}

pub fn wriggle(skeleton: &Skeleton, tick: u64) -> JointTargets {
    let mut targets = JointTargets::new(skeleton);
    wriggle_into(tick, &mut targets);
    targets
}

/// Steps `ticks` ticks of [`wriggle`].
pub fn run(character: &mut Character, ticks: u64) {
    for _ in 0..ticks {
        let targets = wriggle(character.model().skeleton(), character.tick());
        character.actuate(&targets);
        character.step().unwrap();
    }
}

pub fn hash(character: &Character) -> u64 {
    character.save().hash()
}

/// Three policies of made-up parameters, "a" to "c", joined by the path "speed", for any skeleton.
pub fn made_up_pack(skeleton: &Skeleton, mjcf: Option<&str>, actuation: ActuationContract) -> CharacterPack {
    const POLICIES: [&str; 3] = ["a", "b", "c"];
    let joints = skeleton.joint_count();
    let sizes = [skeleton.policy_input_len(), 24, joints];
    let scaling = ActionScaling::from_skeleton(skeleton);
    let edge = |a: &str, b: &str| EdgeEntry {
        nodes: [a.into(), b.into()],
        seconds: 0.5,
        seconds_back: None,
        transit: false,
    };
    let manifest = Manifest {
        format: PACK_FORMAT.into(),
        version: PACK_VERSION,
        character: "made up".into(),
        control_hz: 30.0,
        observation: OBSERVATION_LAYOUT.into(),
        discriminator: DISCRIMINATOR_LAYOUT.into(),
        checksum: None,
        skeleton: skeleton.into(),
        actuation: Some(actuation),
        credits: Vec::new(),
        mjcf: mjcf.map(str::to_owned),
        action_centre: scaling.centre().to_vec(),
        action_gain: scaling.gain().to_vec(),
        policies: POLICIES.map(|name| policy_entry(name, &sizes)).into(),
        edges: vec![edge("a", "b"), edge("b", "c")],
        paths: vec![PathEntry { name: "speed".into(), nodes: POLICIES.map(String::from).into() }],
        discriminators: Vec::new(),
        skills: Vec::new(),
        recovery: None,
    };
    let normaliser =
        |count: usize| Normaliser::from_mean_and_deviation(&vec![0.0; count], &vec![1.0; count]).unwrap();
    let tensors = PackTensors {
        policies: (1..=3).map(|seed| made_up_policy(&sizes, seed)).collect(),
        discriminators: Vec::new(),
        observation_normaliser: normaliser(skeleton.observation_len()),
        discriminator_normaliser: normaliser(skeleton.frame_len()),
        mesh: None,
    };
    CharacterPack::from_parts(manifest, tensors).unwrap()
}

fn policy_entry(name: &str, sizes: &[usize]) -> PolicyEntry {
    PolicyEntry {
        name: name.into(),
        layers: sizes.into(),
        origin: "made up".into(),
        ..PolicyEntry::default()
    }
}

fn made_up_policy(sizes: &[usize], seed: u32) -> Mlp {
    let mut state = seed;
    let mut noise = |count: usize| -> Vec<f32> {
        let mut number = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            ((state >> 8) as f32 / (1 << 23) as f32 - 1.0) * 0.08
        };
        (0..count).map(|_| number()).collect()
    };
    let layers = sizes.windows(2).map(|w| {
        let (weight, bias) = (noise(w[0] * w[1]), noise(w[1]));
        Layer::from_input_major(w[0], w[1], &weight, &bias).unwrap()
    });
    Mlp::from_layers(layers.collect()).unwrap()
}
