//! Made-up policies and a made-up pack, so that no test needs trained ones.
#![allow(dead_code, reason = "each test file uses its part")]

use glam::Vec3;
use policy_core::format::{
    DISCRIMINATOR_LAYOUT, DiscriminatorEntry, EdgeEntry, EndEntry, Manifest, OBSERVATION_LAYOUT, PACK_FORMAT,
    PACK_VERSION, PathEntry, PolicyEntry, SkeletonEntry, SkillEntry, Storage,
};
use policy_core::training::{Layer, Normaliser, PackTensors};
use policy_core::{
    CharacterPack, CharacterState, Controller, ControllerState, Mlp, NodeId, PolicyId, Skeleton,
};

/// Numbers of the humanoid's layouts.
pub const INPUT: usize = 225;
pub const JOINTS: usize = 28;
const DISCRIMINATOR_INPUT: usize = 625;

/// The policy of an index.
pub fn p(index: usize) -> PolicyId {
    PolicyId::new(index)
}

/// The node of an index.
pub fn n(index: usize) -> NodeId {
    NodeId::new(index)
}

/// A state of the humanoid that stands.
pub fn standing() -> CharacterState {
    let skeleton = Skeleton::humanoid();
    let mut state = CharacterState::new(&skeleton);
    state.bodies.iter_mut().for_each(|b| b.position.z = 0.9);
    state.body_mut(skeleton.head().unwrap()).position.z = 1.4;
    state
}

/// Index of the made-up pack's policy of this name.
pub fn policy(name: &str) -> usize {
    manifest().policies.iter().position(|policy| policy.name == name).unwrap()
}

/// Policies that acted in the last tick and their weights in the first layer.
pub fn acted(controller: &Controller) -> Vec<(usize, f32)> {
    controller.report().blend.terms().iter().map(|term| (term.policy.index(), term.weights[0])).collect()
}

/// A body that stands on its feet and moves as a whole, metres per second.
pub fn moving(velocity: Vec3) -> CharacterState {
    let mut state = standing();
    for body in &mut state.bodies {
        body.linear_velocity = velocity;
    }
    for foot in Skeleton::humanoid().feet() {
        state.body_mut(*foot).position.z = 0.07;
    }
    state
}

/// Weight of a policy among those.
pub fn weight(acted: &[(usize, f32)], policy: usize) -> f32 {
    acted.iter().filter(|term| term.0 == policy).map(|term| term.1).sum()
}

/// Weight of the policy of a name in the last tick; all weights add up to 1.
pub fn weight_of(controller: &Controller, name: &str) -> f32 {
    let acted = acted(controller);
    assert!((acted.iter().map(|term| term.1).sum::<f32>() - 1.0).abs() < 1e-6, "{acted:?}");
    weight(&acted, policy(name))
}

/// A controller's state, and the same through bytes.
pub fn saved_and_read(controller: &Controller) -> [ControllerState; 2] {
    let mut saved = ControllerState::new(controller.pack());
    controller.save_into(&mut saved);
    let mut bytes = vec![0; saved.byte_len()];
    saved.write_bytes(&mut bytes);
    let mut read = ControllerState::new(controller.pack());
    read.read_bytes(controller.pack(), &bytes).unwrap();
    [saved, read]
}

/// Lets `to` go on where `from` is, through bytes.
pub fn hand_over(from: &Controller, to: &mut Controller) {
    let [_, read] = saved_and_read(from);
    to.restore(&read).unwrap();
}

pub const POLICY_SIZES: [usize; 4] = [INPUT, 128, 32, JOINTS];

/// A small generator that gives the same numbers everywhere.
pub struct Noise(pub u32);

impl Noise {
    /// In [-1, 1).
    pub fn number(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.0 >> 8) as f32 / (1 << 23) as f32 - 1.0
    }

    pub fn numbers(&mut self, count: usize, scale: f32) -> Vec<f32> {
        (0..count).map(|_| self.number() * scale).collect()
    }
}

pub fn mlp(sizes: &[usize], seed: u32) -> Mlp {
    let mut noise = Noise(seed);
    let layers = sizes.windows(2).map(|w| {
        let (weight, bias) = (noise.numbers(w[0] * w[1], 0.1), noise.numbers(w[1], 0.1));
        Layer::from_input_major(w[0], w[1], &weight, &bias).unwrap()
    });
    Mlp::from_layers(layers.collect()).unwrap()
}

pub const NODES: [&str; 7] = ["idle", "walk", "jog", "run", "crouch", "crawl", "roll"];

/// The manifest of a pack that stands at `idle`, walks at 1 m/s, jogs at 2 m/s and crouches at 0.4 m/s, with a change to each of the first three.
pub fn gaits(mut change: impl FnMut(&mut PolicyEntry)) -> Manifest {
    let mut manifest = manifest();
    for (gait, speed) in manifest.policies.iter_mut().zip([0.0, 1.0, 2.0]) {
        gait.speed_mps = Some(speed);
        change(gait);
    }
    manifest.policies[policy("crouch")].speed_mps = Some(0.4);
    manifest
}

pub fn manifest() -> Manifest {
    let policy = |name: &str| PolicyEntry {
        name: name.into(),
        layers: POLICY_SIZES.into(),
        fall_height: (!["crawl", "roll"].contains(&name)).then_some(0.5),
        origin: "made up".into(),
        ..PolicyEntry::default()
    };
    let edge = |a: &str, b: &str| EdgeEntry {
        nodes: [a.into(), b.into()],
        seconds: 0.5,
        seconds_back: None,
        transit: false,
    };
    let path = |name: &str, nodes: &[&str]| PathEntry {
        name: name.into(),
        nodes: nodes.iter().map(|n| (*n).into()).collect(),
    };
    let end = EndEntry {
        threshold: 0.5,
        hysteresis: 0.1,
        hold_seconds: 5.0 / 30.0,
        minimum_seconds: 0.2,
        limit_seconds: 3.0,
        minimum_height: 0.0,
    };
    let skill = |name: &str, entry: &[&str]| SkillEntry {
        name: name.into(),
        policy: "roll".into(),
        entry: entry.iter().map(|n| (*n).into()).collect(),
        minimum_speed_mps: 0.0,
        maximum_speed_mps: None,
        on_footfall: false,
        in_stride: Vec::new(),
        clock_seconds: None,
        returns_to: "walk".into(),
        discriminator: Some("walk".into()),
        end,
    };
    Manifest {
        format: PACK_FORMAT.into(),
        version: PACK_VERSION,
        character: "made up".into(),
        control_hz: 30.0,
        observation: OBSERVATION_LAYOUT.into(),
        discriminator: DISCRIMINATOR_LAYOUT.into(),
        checksum: None,
        skeleton: SkeletonEntry::from(&Skeleton::humanoid()),
        actuation: None,
        credits: Vec::new(),
        mjcf: None,
        action_centre: vec![0.0; JOINTS],
        action_gain: vec![1.0; JOINTS],
        policies: NODES.map(policy).into(),
        edges: vec![
            edge("idle", "walk"),
            edge("jog", "walk"),
            edge("jog", "run"),
            edge("crouch", "walk"),
            edge("crouch", "crawl"),
        ],
        paths: vec![
            path("speed", &["idle", "walk", "jog", "run"]),
            path("stance", &["idle", "walk", "crouch", "crawl"]),
        ],
        discriminators: vec![DiscriminatorEntry {
            name: "walk".into(),
            layers: vec![DISCRIMINATOR_INPUT, 8, 1],
            storage: Storage::F32,
        }],
        skills: vec![skill("roll", &["walk", "jog"]), skill("get_up", &[])],
        recovery: Some("get_up".into()),
    }
}

/// A normaliser that changes nothing but clips.
pub fn normaliser(len: usize) -> Normaliser {
    Normaliser::from_mean_and_deviation(&vec![0.0; len], &vec![1.0; len]).unwrap()
}

/// Tensors of [`manifest`]; the discriminator always gives `logit`.
pub fn tensors(logit: f32) -> PackTensors {
    let hidden =
        Layer::from_input_major(DISCRIMINATOR_INPUT, 8, &vec![0.0; DISCRIMINATOR_INPUT * 8], &[0.0; 8]);
    let output = Layer::from_input_major(8, 1, &[0.0; 8], &[logit]);
    PackTensors {
        policies: (0..NODES.len() as u32).map(|i| mlp(&POLICY_SIZES, i + 1)).collect(),
        discriminators: vec![Mlp::from_layers(vec![hidden.unwrap(), output.unwrap()]).unwrap()],
        observation_normaliser: normaliser(INPUT - 2),
        discriminator_normaliser: normaliser(125),
        mesh: None,
    }
}

pub fn pack(logit: f32) -> CharacterPack {
    CharacterPack::from_parts(manifest(), tensors(logit)).unwrap()
}
