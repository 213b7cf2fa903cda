//! A pack as a folder of ONNX models with a deployment file.

use std::path::Path;

use policy_core::training::{Layer, NORMALISED_LIMIT, Normaliser, TARGET_LEN};
use policy_core::{CharacterPack, Mlp, PathId, PolicyId};

use super::deployment::{DEPLOYMENT_FILE, Deployment, MJCF_FILE};
use super::error::OnnxError;
use super::graph::{GraphBuilder, Size};
use super::{ACTION, BLEND, OBSERVATION};
use files::write_atomically;

/// Writes one model for each policy and path, the body where the pack has one, and the deployment file. Makes the folder.
/// Returns the names of the files.
///
/// # Errors
/// When a file can't be written.
pub fn export(pack: &CharacterPack, folder: &Path) -> Result<Vec<String>, OnnxError> {
    let deployment = Deployment::of(pack);
    std::fs::create_dir_all(folder).map_err(|error| OnnxError::File { path: folder.to_owned(), error })?;
    let mut files = Vec::new();
    for (index, model) in deployment.policies.iter().enumerate() {
        files.push((model.file.clone(), policy_model(pack, PolicyId::new(index))));
    }
    for (index, model) in deployment.paths.iter().enumerate() {
        files.push((model.file.clone(), path_model(pack, PathId::new(index))));
    }
    if let Some(mjcf) = pack.mjcf() {
        files.push((MJCF_FILE.to_owned(), mjcf.as_bytes().to_vec()));
    }
    files.push((DEPLOYMENT_FILE.to_owned(), deployment.to_json().into_bytes()));
    for (name, bytes) in &files {
        let path = folder.join(name);
        write_atomically(&path, bytes).map_err(|error| OnnxError::File { path, error })?;
    }
    Ok(files.into_iter().map(|(name, _)| name).collect())
}

/// A policy with the normaliser inside: from raw observation and target `[batch, policy_input_len]` to action
/// `[batch, joints]`.
///
/// # Panics
/// When the pack has no such policy.
#[must_use]
pub fn policy_model(pack: &CharacterPack, policy: PolicyId) -> Vec<u8> {
    let network = &pack.policies()[policy.index()];
    let mut graph = GraphBuilder::new("policy", network.inputs());
    let mut flow = normalised(&mut graph, &pack.tensors().observation_normaliser);
    let layers = network.layers();
    for (index, layer) in layers.iter().enumerate() {
        let (n, weight, bias) = (index + 1, weight(layer), bias(layer));
        let weight = graph.floats(format!("weight{n}"), &[layer.inputs(), layer.outputs()], &weight);
        let bias = graph.floats(format!("bias{n}"), &[layer.outputs()], &bias);
        flow = sum_and_relu(&mut graph, [&flow, &weight, &bias], n, layers.len());
    }
    let name = &pack.graph().nodes()[policy.index()].name;
    graph.finish(ACTION, network.outputs(), &format!("policy {name}: raw observation and target to action"))
}

/// The policies of a path in one model that blends their parameters: from raw observation and target
/// `[batch, policy_input_len]` and blend weights `[layers, nodes of the path]` to action `[batch, joints]`. All characters of
/// a batch share the blend.
///
/// # Panics
/// When the pack has no such path.
#[must_use]
pub fn path_model(pack: &CharacterPack, path: PathId) -> Vec<u8> {
    let path = &pack.graph().paths()[path.index()];
    let policies: Vec<&Mlp> = path.nodes().iter().map(|node| &pack.policies()[node.index()]).collect();
    // A path has two nodes or more, and all policies of a pack have the same layers.
    let (first, count) = (policies[0], policies.len());
    let layers = first.layers().len();
    let mut graph = GraphBuilder::new("path", first.inputs());
    graph.input(BLEND, [Size::Fixed(layers), Size::Fixed(count)]);
    let mut flow = normalised(&mut graph, &pack.tensors().observation_normaliser);
    for (index, shape) in first.layers().iter().enumerate() {
        let (n, inputs, outputs) = (index + 1, shape.inputs(), shape.outputs());
        let all = |numbers: &dyn Fn(&Layer) -> Vec<f32>| -> Vec<f32> {
            policies.iter().flat_map(|policy| numbers(&policy.layers()[index])).collect()
        };
        let weights = graph.floats(format!("weights{n}"), &[count, inputs * outputs], &all(&weight));
        let biases = graph.floats(format!("biases{n}"), &[count, outputs], &all(&bias));
        let row = graph.integers(format!("layer{n}"), &[index]);
        let blend = graph.node("Gather", &[BLEND, &row], format!("blend{n}"));
        graph.attribute("axis", 0);
        let flat = graph.node("MatMul", &[&blend, &weights], format!("flat{n}"));
        let shape = graph.integers(format!("shape{n}"), &[inputs, outputs]);
        let weight = graph.node("Reshape", &[&flat, &shape], format!("weight{n}"));
        let bias = graph.node("MatMul", &[&blend, &biases], format!("bias{n}"));
        flow = sum_and_relu(&mut graph, [&flow, &weight, &bias], n, layers);
    }
    let doc = format!("path {}: raw observation and target, and blend weights, to action", path.name());
    graph.finish(ACTION, first.outputs(), &doc)
}

/// Subtracts the mean, divides by the deviation and clips. The target stays as it is: it lies within the limits.
fn normalised(graph: &mut GraphBuilder, normaliser: &Normaliser) -> String {
    let padded = |numbers: &[f32], rest: f32| [numbers, &[rest; TARGET_LEN]].concat();
    let (mean, deviation) = (padded(normaliser.mean(), 0.0), padded(normaliser.deviation(), 1.0));
    let mean = graph.floats("mean", &[mean.len()], &mean);
    let centred = graph.node("Sub", &[OBSERVATION, &mean], "centred");
    let deviation = graph.floats("deviation", &[deviation.len()], &deviation);
    let scaled = graph.node("Div", &[&centred, &deviation], "scaled");
    let least = graph.floats("least", &[], &[-NORMALISED_LIMIT]);
    let most = graph.floats("most", &[], &[NORMALISED_LIMIT]);
    graph.node("Clip", &[&scaled, &least, &most], "normalised")
}

/// Layer `n` of so many: the last is the action, a Relu follows the others.
fn sum_and_relu(graph: &mut GraphBuilder, inputs: [&str; 3], n: usize, layers: usize) -> String {
    if n == layers {
        return graph.node("Gemm", &inputs, ACTION);
    }
    let sum = graph.node("Gemm", &inputs, format!("sum{n}"));
    graph.node("Relu", &[&sum], format!("hidden{n}"))
}

fn weight(layer: &Layer) -> Vec<f32> {
    layer.weight().collect()
}

fn bias(layer: &Layer) -> Vec<f32> {
    layer.bias().collect()
}
