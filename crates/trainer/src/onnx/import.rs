//! ONNX models as policies of a pack. A graph is read by following its operators, so that a model may come from another
//! program: Sub, Div and Clip, then Gemm and Relu in turn. Anything else is refused.

use std::path::Path;

use policy_core::training::{Layer, MAX_LAYERS, NORMALISED_LIMIT, Normaliser, TARGET_LEN};
use policy_core::{CharacterPack, Mlp};
use prost::Message as _;

use super::OPSET;
use super::deployment::{DEPLOYMENT_FILE, Deployment, PolicyFile};
use super::error::OnnxError;
use super::proto::{GraphProto, ModelProto, NodeProto};
use files::{quoted, read_bounded, read_text_bounded};

/// Largest model, bytes: a million parameters. An empty node takes two bytes and becomes some hundred in memory.
const MOST_MODEL_BYTES: u64 = 4 << 20;

/// Largest deployment file, bytes.
const MOST_DEPLOYMENT_BYTES: u64 = 4 << 20;

/// A policy and the normaliser inside its model.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportedPolicy {
    /// The network.
    pub network: Mlp,
    /// Of the observation, without the target.
    pub normaliser: Normaliser,
}

/// The pack with the policies and the normaliser of the models that a deployment file names. Graph, skills, discriminators and
/// the rest stay as they are.
///
/// # Errors
/// When a file can't be read, a model is no policy's, the names differ from the pack's, or the pack refuses a policy.
pub fn import(pack: &CharacterPack, folder: &Path) -> Result<CharacterPack, OnnxError> {
    let path = folder.join(DEPLOYMENT_FILE);
    let json = read_text_bounded(&path, MOST_DEPLOYMENT_BYTES);
    let json = json.map_err(|error| OnnxError::File { path: path.clone(), error })?;
    let deployment = Deployment::from_json(&json).map_err(|found| OnnxError::Deployment { path, found })?;
    let (mut manifest, mut tensors) = (pack.manifest().clone(), pack.tensors().clone());
    let mut normaliser: Option<Normaliser> = None;
    for (entry, network) in manifest.policies.iter_mut().zip(&mut tensors.policies) {
        let model = deployment.policies.iter().find(|model| model.name == entry.name);
        let model = model.filter(|_| deployment.policies.len() == pack.policies().len());
        let imported = read(model.ok_or_else(|| different(pack, &deployment))?, folder)?;
        if *normaliser.get_or_insert_with(|| imported.normaliser.clone()) != imported.normaliser {
            return Err(OnnxError::Normaliser { policy: entry.name.clone() });
        }
        let outputs = imported.network.layers().iter().map(Layer::outputs);
        entry.layers = std::iter::once(imported.network.inputs()).chain(outputs).collect();
        *network = imported.network;
    }
    tensors.observation_normaliser = normaliser.unwrap_or(tensors.observation_normaliser);
    Ok(CharacterPack::from_parts(manifest, tensors)?)
}

fn different(pack: &CharacterPack, deployment: &Deployment) -> OnnxError {
    OnnxError::Policies {
        expected: pack.graph().nodes().iter().map(|node| node.name.clone()).collect(),
        found: deployment.policies.iter().take(100).map(|model| quoted(&model.name)).collect(),
    }
}

fn read(model: &PolicyFile, folder: &Path) -> Result<ImportedPolicy, OnnxError> {
    let name = Path::new(&model.file).file_name().filter(|name| *name == model.file.as_str());
    let Some(name) = name else {
        return Err(OnnxError::Deployment {
            path: folder.join(DEPLOYMENT_FILE),
            found: format!("the path {:?} where a file's name belongs", quoted(&model.file)),
        });
    };
    let path = folder.join(name);
    let bytes = read_bounded(&path, MOST_MODEL_BYTES).map_err(|error| OnnxError::File { path, error })?;
    read_policy(&model.name, &bytes)
}

/// The policy of an ONNX model that [`export`](super::export()) wrote or that is built likewise.
///
/// # Errors
/// When the bytes are no model, or the graph is not that of a policy with its normaliser.
pub fn read_policy(policy: &str, bytes: &[u8]) -> Result<ImportedPolicy, OnnxError> {
    let model = ModelProto::decode(bytes)
        .map_err(|e| OnnxError::Model { policy: policy.to_owned(), found: quoted(&e.to_string()) })?;
    let graph = model.graph.unwrap_or_default();
    let start = graph.input.first().map(|input| input.name.clone()).unwrap_or_default();
    let mut chain = Chain { policy, graph: &graph, at: start, used: 0 };
    let standard = model.opset_import.iter().find(|set| set.domain.is_empty());
    let opset = standard.map_or(0, |set| set.version);
    if opset < OPSET {
        return Err(chain.wrong(format!("operators of version {OPSET} or later"), opset.to_string()));
    }
    let normaliser = chain.normaliser()?;
    let network = chain.network()?;
    if chain.used != graph.node.len() {
        let (expected, found) = (chain.used, graph.node.len());
        return Err(chain.wrong(format!("a chain of {expected} operators"), format!("{found} operators")));
    }
    Ok(ImportedPolicy { network, normaliser })
}

/// A walk from the input along the operators.
struct Chain<'a> {
    policy: &'a str,
    graph: &'a GraphProto,
    /// Name of the tensor that the next operator takes.
    at: String,
    /// Operators behind us.
    used: usize,
}

impl<'a> Chain<'a> {
    fn wrong(&self, expected: impl Into<String>, found: impl AsRef<str>) -> OnnxError {
        let (policy, found) = (self.policy.to_owned(), quoted(found.as_ref()));
        OnnxError::Graph { policy, expected: expected.into(), found }
    }

    /// Goes on to the one operator that takes the present tensor.
    fn next(&mut self, op_type: &str, inputs: usize) -> Result<&'a NodeProto, OnnxError> {
        let at = &self.at;
        let mut takers = self.graph.node.iter().filter(|node| node.input.first() == Some(at));
        let (taker, other) = (takers.next(), takers.next());
        let expected = || format!("one {op_type} with {inputs} inputs after {:?}", quoted(at));
        let node = match (taker, other) {
            (Some(node), None) => node,
            (None, _) => return Err(self.wrong(expected(), "none")),
            (Some(_), Some(_)) => return Err(self.wrong(expected(), "several operators")),
        };
        if node.op_type != op_type || node.input.len() != inputs || node.output.len() != 1 {
            let found = format!("{} with {} inputs", node.op_type, node.input.len());
            return Err(self.wrong(expected(), found));
        }
        // There is one output, and callers index no more inputs than they asked for.
        self.at.clone_from(&node.output[0]);
        self.used += 1;
        Ok(node)
    }

    /// Shape and numbers of a constant.
    fn constant(&self, name: &str) -> Result<(&'a [i64], Vec<f32>), OnnxError> {
        let tensor = self.graph.initializer.iter().find(|tensor| tensor.name == name);
        let numbers = tensor.and_then(|tensor| Some((tensor.dims.as_slice(), tensor.floats()?)));
        let expected = || format!("a constant of 32-bit reals called {:?}", quoted(name));
        numbers.ok_or_else(|| self.wrong(expected(), "none"))
    }

    fn normaliser(&mut self) -> Result<Normaliser, OnnxError> {
        let mut numbers = Vec::new();
        for (op_type, of_target) in [("Sub", 0.0), ("Div", 1.0)] {
            let node = self.next(op_type, 2)?;
            let (_, mut all) = self.constant(&node.input[1])?;
            let target = all.split_off(all.len().saturating_sub(TARGET_LEN));
            if target != [of_target; TARGET_LEN] {
                let expected = format!("{op_type} that leaves the last {TARGET_LEN} numbers as they are");
                return Err(self.wrong(expected, format!("{target:?}")));
            }
            numbers.push(all);
        }
        let node = self.next("Clip", 3)?;
        for (name, limit) in node.input[1..].iter().zip([-NORMALISED_LIMIT, NORMALISED_LIMIT]) {
            let (_, found) = self.constant(name)?;
            if found != [limit] {
                return Err(self.wrong(format!("Clip at {limit}"), format!("{:.20?}", found.first())));
            }
        }
        // The loop above pushed two lists.
        Normaliser::from_mean_and_deviation(&numbers[0], &numbers[1])
            .map_err(|e| self.wrong("mean and deviation of a normaliser", e.to_string()))
    }

    fn network(&mut self) -> Result<Mlp, OnnxError> {
        let end = self.graph.output.first().map(|output| output.name.clone()).unwrap_or_default();
        let mut layers = Vec::new();
        loop {
            layers.push(self.layer()?);
            if self.at == end {
                return Mlp::from_layers(layers).map_err(|e| self.wrong("layers of a policy", e.to_string()));
            }
            if layers.len() == MAX_LAYERS {
                return Err(self.wrong(format!("at most {MAX_LAYERS} layers"), "more"));
            }
            self.next("Relu", 1)?;
        }
    }

    fn layer(&mut self) -> Result<Layer, OnnxError> {
        let node = self.next("Gemm", 3)?;
        let mut transposed = false;
        for attribute in &node.attribute {
            let sound = match attribute.name.as_str() {
                "alpha" | "beta" => attribute.f == Some(1.0),
                "transA" => attribute.i.unwrap_or(0) == 0,
                "transB" => {
                    transposed = attribute.i.unwrap_or(0) != 0;
                    true
                }
                _ => false,
            };
            if !sound {
                let expected = "Gemm with alpha 1, beta 1 and transA 0";
                return Err(self.wrong(expected, format!("{:?}", quoted(&attribute.name))));
            }
        }
        let ((shape, weight), (_, bias)) = (self.constant(&node.input[1])?, self.constant(&node.input[2])?);
        let &[rows, columns] = shape else {
            return Err(self.wrong("a matrix of weights", format!("{} dimensions", shape.len())));
        };
        if weight.is_empty() {
            // One size may be 0 and the other anything.
            return Err(self.wrong("a matrix of weights", format!("one of {rows} times {columns}")));
        }
        // As many numbers as the shape says were found, so both fit.
        let (rows, columns) = (rows as usize, columns as usize);
        let layer = match transposed {
            false => Layer::from_input_major(rows, columns, &weight, &bias),
            true => Layer::from_input_major(columns, rows, &transpose(&weight, rows, columns), &bias),
        };
        layer.map_err(|e| self.wrong("a layer of a policy", e.to_string()))
    }
}

/// A matrix of `rows` times `columns`, row by row, turned over.
fn transpose(matrix: &[f32], rows: usize, columns: usize) -> Vec<f32> {
    (0..columns).flat_map(|column| (0..rows).map(move |row| matrix[row * columns + column])).collect()
}
