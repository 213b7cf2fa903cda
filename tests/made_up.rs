//! A pack with policies of made-up parameters, for a skeleton that nothing was trained for.

use physics_bridge::Model;
use policy_core::format::{
    CreditEntry, DISCRIMINATOR_LAYOUT, DiscriminatorEntry, EdgeEntry, EndEntry, Manifest, OBSERVATION_LAYOUT,
    PACK_FORMAT, PACK_VERSION, PathEntry, PolicyEntry, SkillEntry, Storage,
};
use policy_core::training::{ActionScaling, Layer, Normaliser, PackTensors};
use policy_core::{CharacterPack, Mlp};

/// Names of the policies and nodes.
pub const POLICIES: [&str; 3] = ["rest", "trot", "bow"];

/// A pack for the body of `model`, with `mjcf` inside: the path "speed" from rest to trot, and the skill "bow", which a
/// discriminator ends.
///
/// # Panics
/// When policy-core refuses it.
#[must_use]
pub fn pack(model: &Model, mjcf: &str) -> CharacterPack {
    let skeleton = model.skeleton();
    let policy_sizes = [skeleton.policy_input_len(), 24, 12, skeleton.joint_count()];
    let discriminator_sizes = [skeleton.discriminator_input_len(), 8, 1];
    let scaling = ActionScaling::from_skeleton(skeleton);
    let policy = |name: &str| PolicyEntry {
        name: name.into(),
        layers: policy_sizes.into(),
        origin: "made up".into(),
        ..PolicyEntry::default()
    };
    let end = EndEntry {
        threshold: 0.5,
        hysteresis: 0.1,
        hold_seconds: 0.1,
        minimum_seconds: 0.2,
        limit_seconds: 1.0,
        minimum_height: 0.0,
    };
    let skill = SkillEntry {
        minimum_speed_mps: 0.0,
        maximum_speed_mps: None,
        on_footfall: false,
        in_stride: Vec::new(),
        clock_seconds: None,
        name: "bow".into(),
        policy: "bow".into(),
        entry: vec!["rest".into(), "trot".into()],
        returns_to: "rest".into(),
        discriminator: Some("rest".into()),
        end,
    };
    let manifest = Manifest {
        format: PACK_FORMAT.into(),
        version: PACK_VERSION,
        character: "made up".into(),
        control_hz: model.control_hz(),
        observation: OBSERVATION_LAYOUT.into(),
        discriminator: DISCRIMINATOR_LAYOUT.into(),
        checksum: None,
        skeleton: (&**skeleton).into(),
        actuation: Some(model.actuation()),
        credits: vec![CreditEntry {
            work: "all of it".into(),
            source: "made up".into(),
            licence: "CC0-1.0".into(),
        }],
        mjcf: Some(mjcf.into()),
        action_centre: scaling.centre().to_vec(),
        action_gain: scaling.gain().to_vec(),
        policies: POLICIES.map(policy).into(),
        edges: vec![EdgeEntry {
            nodes: ["rest".into(), "trot".into()],
            seconds: 0.5,
            seconds_back: Some(0.25),
            transit: false,
        }],
        paths: vec![PathEntry { name: "speed".into(), nodes: vec!["rest".into(), "trot".into()] }],
        discriminators: vec![DiscriminatorEntry {
            name: "rest".into(),
            layers: discriminator_sizes.into(),
            storage: Storage::F16,
        }],
        skills: vec![skill],
        recovery: None,
    };
    let normaliser = |count: usize| {
        Normaliser::from_mean_and_deviation(&vec![0.0; count], &vec![1.0; count]).expect("finite numbers")
    };
    let tensors = PackTensors {
        policies: (1..=3).map(|seed| network(&policy_sizes, seed)).collect(),
        discriminators: vec![network(&discriminator_sizes, 9)],
        observation_normaliser: normaliser(skeleton.observation_len()),
        discriminator_normaliser: normaliser(skeleton.frame_len()),
        mesh: None,
    };
    CharacterPack::from_parts(manifest, tensors).expect("the made-up pack is sound")
}

/// A network of small numbers, the same everywhere.
fn network(sizes: &[usize], seed: u32) -> Mlp {
    let mut state = seed;
    let mut noise = |count: usize| -> Vec<f32> {
        let mut number = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            ((state >> 8) as f32 / (1 << 23) as f32 - 1.0) * 0.06
        };
        (0..count).map(|_| number()).collect()
    };
    let layers = sizes.windows(2).map(|w| {
        let (weight, bias) = (noise(w[0] * w[1]), noise(w[1]));
        Layer::from_input_major(w[0], w[1], &weight, &bias).expect("made to shape")
    });
    Mlp::from_layers(layers.collect()).expect("made to shape")
}
