//! Models of `trainer export` under ONNX Runtime and tract beside policy-core, on 1,000 observations each.
//! `cargo xtask onnx` exports the shipped pack and runs this.

use std::path::{Path, PathBuf};

use ort::session::Session;
use ort::value::TensorRef;
use policy_core::training::{BlendTerm, TARGET_LEN};
use policy_core::{Arithmetic, Blend, CharacterPack, MlpScratch, PolicyId};
use tract_onnx::prelude::*;

/// How far a model may differ from policy-core.
const TOLERANCE: f32 = 1e-5;

/// Observations that are compared, all in one batch.
const COUNT: usize = 1000;

/// A model, what goes in, and what policy-core makes of it.
struct Case {
    file: PathBuf,
    /// Shape and numbers of each input.
    inputs: Vec<([usize; 2], Vec<f32>)>,
    expected: Vec<f32>,
}

#[test]
fn onnx_runtime_and_tract_agree_with_the_core() {
    let variable = |name| std::env::var_os(name).expect("set by `cargo xtask onnx`");
    let (pack, folder) = (variable("POLICY_SPACE_PACK"), PathBuf::from(variable("POLICY_SPACE_ONNX")));
    let pack = CharacterPack::from_bytes(&std::fs::read(pack).unwrap()).unwrap();
    let environment =
        ort::init_from(variable("ORT_DYLIB_PATH")).unwrap().with_telemetry(false).build().unwrap();
    for case in cases(&pack, &folder) {
        let mut session = Session::builder(&environment).unwrap().commit_from_file(&case.file).unwrap();
        let differences = [onnx_runtime(&mut session, &case), tract(&case)].map(|found| worst(&case, &found));
        let largest = case.expected.iter().fold(0.0_f32, |most, a| most.max(a.abs()));
        let [ort, tract] = differences;
        let name = case.file.file_name().unwrap().display();
        println!("{name}: ONNX Runtime {ort:.1e}, tract {tract:.1e}; largest action {largest:.2}");
        assert!(differences.iter().all(|d| *d <= TOLERANCE), "{name}: {differences:?}");
    }
}

fn worst(case: &Case, found: &[f32]) -> f32 {
    assert_eq!(found.len(), case.expected.len());
    found.iter().zip(&case.expected).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

fn onnx_runtime(session: &mut Session, case: &Case) -> Vec<f32> {
    let inputs: Vec<_> = case
        .inputs
        .iter()
        .map(|(shape, numbers)| {
            ort::session::SessionInputValue::from(
                TensorRef::from_array_view((*shape, numbers.as_slice())).unwrap(),
            )
        })
        .collect();
    let outputs = session.run(inputs.as_slice()).unwrap();
    outputs[0].try_extract_tensor::<f32>().unwrap().1.to_vec()
}

fn tract(case: &Case) -> Vec<f32> {
    let mut model = tract_onnx::onnx().model_for_path(&case.file).unwrap();
    for (index, (shape, _)) in case.inputs.iter().enumerate() {
        model = model.with_input_fact(index, f32::fact(shape).into()).unwrap();
    }
    let inputs =
        case.inputs.iter().map(|(shape, numbers)| Tensor::from_shape(shape, numbers).unwrap().into());
    let plan = model.into_optimized().unwrap().into_runnable().unwrap();
    let outputs = plan.spawn().unwrap().run(inputs.collect()).unwrap();
    outputs[0].try_as_plain_ram().unwrap().as_slice::<f32>().unwrap().to_vec()
}

/// Every policy, and every path with weights of its own for each layer.
fn cases(pack: &CharacterPack, folder: &Path) -> Vec<Case> {
    let mut noise = Noise(5);
    let rows = observations(pack, &mut noise);
    let observation = ([COUNT, pack.skeleton().policy_input_len()], rows.clone());
    let (graph, layers) = (pack.graph(), pack.policies()[0].layers().len());
    let mut cases = Vec::new();
    for (index, node) in graph.nodes().iter().enumerate() {
        cases.push(Case {
            file: folder.join(format!("policy_{}.onnx", node.name)),
            inputs: vec![observation.clone()],
            expected: expected(pack, &Blend::single(PolicyId::new(index)), &rows),
        });
    }
    for path in graph.paths() {
        let count = path.nodes().len();
        let (mut blend, mut table) = (Blend::default(), vec![0.0; layers * count]);
        for row in table.chunks_exact_mut(count) {
            row[1..].iter_mut().for_each(|weight| *weight = 0.5 * noise.number());
            row[0] = 1.0 - row.iter().sum::<f32>();
        }
        for (column, node) in path.nodes().iter().enumerate() {
            let mut weights = [0.0; 4];
            (0..layers).for_each(|layer| weights[layer] = table[layer * count + column]);
            blend.push(BlendTerm { policy: PolicyId::from(*node), weights }).unwrap();
        }
        cases.push(Case {
            file: folder.join(format!("path_{}.onnx", path.name())),
            inputs: vec![observation.clone(), ([layers, count], table)],
            expected: expected(pack, &blend, &rows),
        });
    }
    cases
}

fn observations(pack: &CharacterPack, noise: &mut Noise) -> Vec<f32> {
    let normaliser = &pack.tensors().observation_normaliser;
    let mut rows = Vec::new();
    for _ in 0..COUNT {
        let numbers = normaliser.mean().iter().zip(normaliser.deviation());
        rows.extend(numbers.map(|(mean, deviation)| mean + deviation * 8.0 * noise.number().powi(3)));
        rows.extend((0..TARGET_LEN).map(|_| 2.5 * noise.number()));
    }
    rows
}

fn expected(pack: &CharacterPack, blend: &Blend, rows: &[f32]) -> Vec<f32> {
    let skeleton = pack.skeleton();
    let mut scratch = MlpScratch::for_mlp(&pack.policies()[0]);
    let (mut actions, mut action) = (Vec::new(), vec![0.0; skeleton.joint_count()]);
    for row in rows.chunks_exact(skeleton.policy_input_len()) {
        let mut input = row.to_vec();
        pack.tensors().observation_normaliser.normalise_in_place(&mut input[..skeleton.observation_len()]);
        blend.evaluate_into(pack.policies(), Arithmetic::Reproducible, &input, &mut scratch, &mut action);
        actions.extend_from_slice(&action);
    }
    actions
}

/// Made-up numbers in [-1, 1).
struct Noise(u32);

impl Noise {
    fn number(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.0 >> 8) as f32 / (1 << 23) as f32 - 1.0
    }
}
