//! What the tests of this folder share.
#![allow(dead_code, reason = "each test file uses a part")]

pub mod harness;

use std::sync::Arc;

use physics_bridge::Model;
use policy_core::format::{
    DISCRIMINATOR_LAYOUT, DiscriminatorEntry, EdgeEntry, EndEntry, Manifest, OBSERVATION_LAYOUT, PACK_FORMAT,
    PACK_VERSION, PathEntry, PolicyEntry, SkeletonEntry, SkillEntry, Storage,
};
use policy_core::training::{ActionScaling, Layer, Normaliser, PackTensors};
use policy_core::{Buttons, CharacterPack, GamepadState, Mlp};
use viewer::app::{App, PanelKind, PanelLayout, Preferences, Side};
use viewer::assets;
use viewer::gpu::Gpu;
use viewer::sim::{SceneKind, SimConfig, Simulation};

/// The stick ahead, and nothing else.
pub const FORWARD: GamepadState = GamepadState {
    left_stick: [0.0, 1.0],
    right_stick: [0.0; 2],
    left_trigger: 0.0,
    right_trigger: 0.0,
    buttons: Buttons::NONE,
};

/// A playground of so many characters that keeps its history.
pub fn playground(characters: usize) -> Simulation {
    let pack = Arc::new(CharacterPack::from_bytes(assets::HUMANOID_PACK).unwrap());
    Simulation::new(pack, playground_config(characters)).unwrap()
}

/// What [`playground`] is made of.
pub fn playground_config(characters: usize) -> SimConfig {
    SimConfig { scene: SceneKind::Playground, characters, history: true, ..SimConfig::default() }
}

/// A world of one character that keeps its history.
pub fn simulation() -> Simulation {
    simulation_of(Arc::new(CharacterPack::from_bytes(assets::HUMANOID_PACK).unwrap()))
}

/// The same with a pack of one's own.
pub fn simulation_of(pack: Arc<CharacterPack>) -> Simulation {
    let config = SimConfig { history: true, ..SimConfig::default() };
    Simulation::new(pack, config).unwrap()
}

/// The advanced layout with these panels open.
pub fn advanced(open: Vec<(PanelKind, Side)>) -> PanelLayout {
    let preferences = Preferences { advanced: true, ..Preferences::default() };
    PanelLayout { open, preferences, ..PanelLayout::default() }
}

/// The demo with one panel open.
pub fn app_with(kind: PanelKind) -> App {
    App::new(simulation(), advanced(vec![(kind, Side::Left)]))
}

/// A device, or a message that says why the test is skipped.
pub fn gpu() -> Option<Gpu> {
    match Gpu::off_screen() {
        Ok(gpu) => Some(gpu),
        Err(error) => {
            eprintln!("skipped: {error}");
            None
        }
    }
}

/// What the made discriminator always says, and the logit that it comes from.
pub const SCORE: f32 = 0.75;
const LOGIT: f32 = 1.098_612_3;

fn discriminator(inputs: usize) -> Mlp {
    let zeros = vec![0.0; inputs];
    Mlp::from_layers(vec![Layer::from_input_major(inputs, 1, &zeros, &[LOGIT]).unwrap()]).unwrap()
}

/// The pack that ships, with a skill that starts from walking and ends by a discriminator of `threshold`, and one to
/// rise again that ends by time.
pub fn pack_with_skills(threshold: f32) -> CharacterPack {
    let ships = CharacterPack::from_bytes(assets::HUMANOID_PACK).unwrap();
    let (mut manifest, mut tensors) = (ships.manifest().clone(), ships.tensors().clone());
    let end = EndEntry {
        threshold,
        hysteresis: 0.1,
        hold_seconds: 5.0 / 30.0,
        minimum_seconds: 0.2,
        limit_seconds: 1.5,
        minimum_height: 0.0,
    };
    let skill = |name: &str, policy: &str, entry: &[&str], discriminator: Option<&str>| SkillEntry {
        minimum_speed_mps: 0.0,
        maximum_speed_mps: None,
        on_footfall: false,
        in_stride: Vec::new(),
        clock_seconds: None,
        name: name.into(),
        policy: policy.into(),
        entry: entry.iter().map(|n| (*n).into()).collect(),
        returns_to: "idle".into(),
        discriminator: discriminator.map(Into::into),
        end,
    };
    manifest.skills =
        vec![skill("hop", "walk", &["walk"], Some("upright")), skill("rise", "idle", &[], None)];
    manifest.recovery = Some("rise".into());
    let inputs = ships.skeleton().discriminator_input_len();
    manifest.discriminators =
        vec![DiscriminatorEntry { name: "upright".into(), layers: vec![inputs, 1], storage: Storage::F32 }];
    tensors.discriminators = vec![discriminator(inputs)];
    // Whatever the policies that ship can do: only who lies has fallen.
    manifest.policies.iter_mut().for_each(|policy| policy.fall_height = Some(0.3));
    for edge in &mut manifest.edges {
        (edge.seconds, edge.seconds_back) = (0.2, None);
    }
    CharacterPack::from_parts(manifest, tensors).unwrap()
}

/// A character of four legs, whose joints have other axes and whose bodies have other names than the humanoid's.
pub const QUADRUPED_MJCF: &str =
    include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/assets/quadruped.xml"));

/// A pack of the quadruped that brings its body. Its two policies are made up: they hold a pose and wave a little.
pub fn quadruped() -> CharacterPack {
    let model = Model::from_mjcf(QUADRUPED_MJCF).unwrap();
    let skeleton = model.skeleton();
    let layers = vec![skeleton.policy_input_len(), 16, 8, skeleton.joint_count()];
    let scaling = ActionScaling::from_skeleton(skeleton);
    let policy = |name: &str, speed_mps: f32| PolicyEntry {
        name: name.into(),
        layers: layers.clone(),
        fall_height: Some(0.05),
        speed_mps: Some(speed_mps),
        origin: "made up".into(),
        ..PolicyEntry::default()
    };
    let manifest = Manifest {
        format: PACK_FORMAT.into(),
        version: PACK_VERSION,
        checksum: None,
        character: "quadruped".into(),
        control_hz: model.control_hz(),
        observation: OBSERVATION_LAYOUT.into(),
        discriminator: DISCRIMINATOR_LAYOUT.into(),
        skeleton: SkeletonEntry::from(&**skeleton),
        actuation: Some(model.actuation()),
        action_centre: scaling.centre().to_vec(),
        action_gain: scaling.gain().to_vec(),
        policies: vec![policy("idle", 0.0), policy("trot", 1.0)],
        edges: vec![EdgeEntry {
            nodes: ["idle".into(), "trot".into()],
            seconds: 0.5,
            seconds_back: None,
            transit: false,
        }],
        paths: vec![PathEntry { name: "speed".into(), nodes: vec!["idle".into(), "trot".into()] }],
        discriminators: Vec::new(),
        skills: Vec::new(),
        recovery: None,
        credits: Vec::new(),
        mjcf: Some(QUADRUPED_MJCF.into()),
    };
    let normaliser =
        |len: usize| Normaliser::from_mean_and_deviation(&vec![0.0; len], &vec![1.0; len]).unwrap();
    let tensors = PackTensors {
        policies: (0..2).map(|seed| made_policy(&layers, seed as f32)).collect(),
        discriminators: Vec::new(),
        observation_normaliser: normaliser(skeleton.observation_len()),
        discriminator_normaliser: normaliser(skeleton.frame_len()),
        mesh: None,
    };
    CharacterPack::from_parts(manifest, tensors).unwrap()
}

fn made_policy(widths: &[usize], seed: f32) -> Mlp {
    let layers = widths.windows(2).map(|w| {
        let weight: Vec<f32> = (0..w[0] * w[1]).map(|i| 0.05 * (seed + i as f32 * 0.37).sin()).collect();
        Layer::from_input_major(w[0], w[1], &weight, &vec![0.0; w[1]]).unwrap()
    });
    Mlp::from_layers(layers.collect()).unwrap()
}
