//! ONNX models: what is exported computes what policy-core computes, and comes back with the same bits.

#[path = "../../../policy-core/tests/common/mod.rs"]
mod common;
mod evaluator;

use common::Noise;
use evaluator::{Tensor, evaluate};
use policy_core::training::{BlendTerm, Normaliser, TARGET_LEN};
use policy_core::{
    Arithmetic, Blend, CharacterPack, MlpScratch, PathId, PolicyId,
    format::{Manifest, PathEntry},
};
use prost::Message as _;
use trainer::onnx::{
    ACTION, BLEND, DEPLOYMENT_FILE, Deployment, ModelProto, OBSERVATION, OnnxError, export, import,
    path_model, policy_model, read_policy,
};

/// How far a model may differ from policy-core.
const TOLERANCE: f32 = 1e-5;

/// Observations that are compared.
const COUNT: usize = 1000;

/// Made-up policies with a normaliser that does something, and a body.
fn pack() -> CharacterPack {
    let mut manifest: Manifest = common::manifest();
    manifest.mjcf = Some("<mujoco/>".into());
    let nodes = ["idle", "walk"].map(Into::into).into();
    manifest.paths.push(PathEntry { name: "Odd name/".into(), nodes });
    let mut tensors = common::tensors(0.0);
    let mut noise = Noise(7);
    let len = common::INPUT - TARGET_LEN;
    let deviation: Vec<f32> = noise.numbers(len, 1.0).iter().map(|n| 0.2 + n.abs()).collect();
    tensors.observation_normaliser =
        Normaliser::from_mean_and_deviation(&noise.numbers(len, 0.5), &deviation).unwrap();
    CharacterPack::from_parts(manifest, tensors).unwrap()
}

/// Raw observations with their targets, some far enough out to be clipped.
fn observations(pack: &CharacterPack) -> Vec<f32> {
    let normaliser = &pack.tensors().observation_normaliser;
    let mut noise = Noise(11);
    let mut rows = Vec::new();
    for _ in 0..COUNT {
        for (mean, deviation) in normaliser.mean().iter().zip(normaliser.deviation()) {
            rows.push(mean + deviation * 2.0 * noise.number().powi(3) * 4.0);
        }
        rows.extend(noise.numbers(TARGET_LEN, 2.5));
    }
    rows
}

/// What policy-core makes of the same rows.
fn expected(pack: &CharacterPack, blend: &Blend, rows: &[f32]) -> Vec<f32> {
    let mut scratch = MlpScratch::for_mlp(&pack.policies()[0]);
    let (mut actions, mut action) = (Vec::new(), [0.0; common::JOINTS]);
    for row in rows.chunks_exact(common::INPUT) {
        let mut input = row.to_vec();
        let observation = &mut input[..common::INPUT - TARGET_LEN];
        pack.tensors().observation_normaliser.normalise_in_place(observation);
        blend.evaluate_into(pack.policies(), Arithmetic::Reproducible, &input, &mut scratch, &mut action);
        actions.extend(action);
    }
    actions
}

#[track_caller]
fn agree(bytes: &[u8], rows: &[f32], blend: Option<Tensor>, expected: &[f32]) {
    let model = ModelProto::decode(bytes).unwrap();
    let rows = Tensor { shape: vec![COUNT, common::INPUT], numbers: rows.to_vec() };
    let mut inputs = vec![(OBSERVATION, rows)];
    inputs.extend(blend.map(|blend| (BLEND, blend)));
    let found = evaluate(&model, inputs, ACTION);
    assert_eq!(found.shape, [COUNT, common::JOINTS]);
    let worst = found.numbers.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(worst <= TOLERANCE, "{worst}");
    assert!(expected.iter().any(|a| a.abs() > 0.1), "the actions are worth comparing");
}

#[test]
fn models_of_policies_compute_what_the_core_computes() {
    let pack = pack();
    let rows = observations(&pack);
    for index in 0..pack.policies().len() {
        let policy = PolicyId::new(index);
        let actions = expected(&pack, &Blend::single(policy), &rows);
        agree(&policy_model(&pack, policy), &rows, None, &actions);
    }
}

#[test]
fn models_of_paths_blend_parameters() {
    let pack = pack();
    let rows = observations(&pack);
    for (index, path) in pack.graph().paths().iter().enumerate() {
        let (mut noise, mut blend) = (Noise(23), Blend::default());
        let count = path.nodes().len();
        // The weights of each layer add up to 1; each layer has its own.
        let mut table = [[0.0; 4]; 4];
        for row in &mut table {
            for weight in &mut row[1..count] {
                *weight = 0.5 * noise.number();
            }
            row[0] = 1.0 - row.iter().sum::<f32>();
        }
        for (column, node) in path.nodes().iter().enumerate() {
            let weights = table.map(|row| row[column]);
            blend.push(BlendTerm { policy: PolicyId::from(*node), weights }).unwrap();
        }
        let numbers = table[..3].iter().flat_map(|row| &row[..count]).copied().collect();
        let weights = Tensor { shape: vec![3, count], numbers };
        let actions = expected(&pack, &blend, &rows);
        agree(&path_model(&pack, PathId::new(index)), &rows, Some(weights), &actions);
    }
}

#[test]
fn what_is_exported_comes_back_with_the_same_bits() {
    let (pack, folder) = (pack(), tempfile::tempdir().unwrap());
    let files = export(&pack, folder.path()).unwrap();
    assert_eq!(files.len(), 7 + 3 + 2, "{files:?}");
    let mut other = pack.tensors().clone();
    other.policies.reverse();
    other.observation_normaliser = common::normaliser(common::INPUT - TARGET_LEN);
    let other = CharacterPack::from_parts(pack.manifest().clone(), other).unwrap();
    assert_ne!(other.to_bytes(), pack.to_bytes());
    assert_eq!(import(&other, folder.path()).unwrap().to_bytes(), pack.to_bytes());
}

#[test]
fn the_deployment_file_says_what_an_engine_needs() {
    let (pack, folder) = (pack(), tempfile::tempdir().unwrap());
    export(&pack, folder.path()).unwrap();
    let json = std::fs::read_to_string(folder.path().join(DEPLOYMENT_FILE)).unwrap();
    let deployment = Deployment::from_json(&json).unwrap();
    assert_eq!(deployment, Deployment::of(&pack));
    assert_eq!((deployment.timing.control_hz, deployment.observation.len), (30.0, common::INPUT));
    let parts = &deployment.observation.parts;
    assert!(parts.windows(2).all(|pair| pair[0].start + pair[0].len == pair[1].start));
    assert_eq!(parts.iter().map(|part| part.len).collect::<Vec<_>>(), [1, 42, 90, 45, 45, 2]);
    assert_eq!(deployment.joints.len(), common::JOINTS);
    assert_eq!(deployment.paths[0].nodes, ["idle", "walk", "jog", "run"]);
    assert_eq!(deployment.paths[0].seconds, [[0.5; 2]; 3]);
    assert_eq!(deployment.paths[2].file, "path_Odd-name--2.onnx");
    for file in deployment.policies.iter().map(|p| &p.file).chain(deployment.mjcf.as_ref()) {
        assert!(folder.path().join(file).is_file(), "{file}");
    }
}

/// A model with something changed is refused with these words.
#[track_caller]
fn refused(words: &str, change: impl FnOnce(&mut ModelProto)) {
    let mut model = ModelProto::decode(policy_model(&pack(), PolicyId::new(1)).as_slice()).unwrap();
    change(&mut model);
    let error = read_policy("walk", &model.encode_to_vec()).unwrap_err();
    assert!(error.to_string().contains(words), "{error}");
}

#[test]
fn graphs_of_something_else_are_refused() {
    refused("version 13 or later, found 7", |m| m.opset_import[0].version = 7);
    refused("one Relu with 1 inputs", |m| m.graph.as_mut().unwrap().node[4].op_type = "Tanh".into());
    refused("found several operators", |m| {
        let graph = m.graph.as_mut().unwrap();
        graph.node.push(graph.node[3].clone());
    });
    refused("a constant of 32-bit reals", |m| m.graph.as_mut().unwrap().initializer[0].dims = vec![1 << 40]);
    refused("a constant of 32-bit reals", |m| m.graph.as_mut().unwrap().initializer[4].data_location = 1);
    refused("Clip at -5", |m| m.graph.as_mut().unwrap().initializer[2].raw_data = 4_f32.to_le_bytes().into());
    refused("leaves the last 2 numbers", |m| {
        *m.graph.as_mut().unwrap().initializer[0].raw_data.last_mut().unwrap() = 64;
    });
    refused("one of 0 times 1099511627776", |m| {
        let graph = m.graph.as_mut().unwrap();
        let attribute =
            trainer::onnx::AttributeProto { name: "transB".into(), i: Some(1), ..Default::default() };
        graph.node[3].attribute.push(attribute);
        graph.initializer[4].dims = vec![0, 1 << 40];
        graph.initializer[4].raw_data.clear();
    });
    refused("[cut]\", found none", |m| m.graph.as_mut().unwrap().node[0].input[1] = "n".repeat(1 << 20));
    refused("[cut]\", found none", |m| m.graph.as_mut().unwrap().node[0].output[0] = "n".repeat(1 << 20));
    refused("found none", |m| m.graph = None);
    refused("finite parameters", |m| {
        m.graph.as_mut().unwrap().initializer[4].raw_data[..4].copy_from_slice(&f32::NAN.to_le_bytes());
    });
    let error = read_policy("walk", b"\xff no model").unwrap_err();
    assert!(matches!(error, OnnxError::Model { .. }), "{error}");
}

#[test]
fn a_transposed_matrix_has_the_same_numbers() {
    let pack = pack();
    let bytes = policy_model(&pack, PolicyId::new(1));
    let mut model = ModelProto::decode(bytes.as_slice()).unwrap();
    let graph = model.graph.as_mut().unwrap();
    let attribute =
        trainer::onnx::AttributeProto { name: "transB".into(), i: Some(1), r#type: 2, ..Default::default() };
    graph.node[3].attribute.push(attribute);
    let weight = &mut graph.initializer[4];
    let numbers = weight.floats().unwrap();
    let (rows, columns) = (weight.dims[0] as usize, weight.dims[1] as usize);
    weight.dims.reverse();
    weight.raw_data.clear();
    weight.float_data =
        (0..columns).flat_map(|c| (0..rows).map(|r| numbers[r * columns + c]).collect::<Vec<_>>()).collect();
    let found = read_policy("walk", &model.encode_to_vec()).unwrap();
    assert_eq!(found, read_policy("walk", &bytes).unwrap());
    assert_eq!(found.network, pack.policies()[1]);
}

#[test]
fn folders_that_do_not_fit_the_pack_are_refused() {
    let (pack, folder) = (pack(), tempfile::tempdir().unwrap());
    export(&pack, folder.path()).unwrap();
    let path = folder.path().join(DEPLOYMENT_FILE);
    let whole = std::fs::read_to_string(&path).unwrap();
    let fails = |text: &str, words: &str| {
        std::fs::write(&path, text).unwrap();
        let error = import(&pack, folder.path()).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    };
    fails(
        &whole.replace("\"name\": \"jog\"", "\"name\": \"trot\""),
        "expected models of the pack's policies",
    );
    fails(&whole.replace("policy_jog.onnx", "../policy_jog.onnx"), "where a file's name belongs");
    fails(&whole.replace("policy_jog.onnx", "policy_none.onnx"), "policy_none.onnx");
    fails(&whole.replace("policy-space deployment", "deployment"), "format \"deployment\"");
    fails("{", "expected a deployment file");
    std::fs::write(&path, &whole).unwrap();
    let mut tensors = pack.tensors().clone();
    tensors.observation_normaliser = common::normaliser(common::INPUT - TARGET_LEN);
    let other = CharacterPack::from_parts(pack.manifest().clone(), tensors).unwrap();
    std::fs::write(folder.path().join("policy_jog.onnx"), policy_model(&other, PolicyId::new(2))).unwrap();
    let error = import(&pack, folder.path()).unwrap_err();
    assert!(matches!(&error, OnnxError::Normaliser { policy } if policy == "jog"), "{error}");
}
