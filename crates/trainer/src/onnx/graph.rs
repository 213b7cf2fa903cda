//! Puts a graph together: nodes, constant tensors, inputs and outputs.

use prost::Message as _;

use super::proto::{
    ATTRIBUTE_INT, AttributeProto, Dimension, FLOAT, GraphProto, INT64, ModelProto, NodeProto,
    OperatorSetIdProto, TensorProto, TensorShapeProto, TensorType, TypeProto, ValueInfoProto,
};
use super::{OBSERVATION, OPSET};

/// Version of the messages that belongs to [`OPSET`].
const IR_VERSION: i64 = 7;

/// Most elements of a tensor that is read; the widest layer of a policy has fewer.
const MOST_ELEMENTS: usize = 1 << 26;

/// A size of an input or output.
#[derive(Clone, Copy)]
pub(super) enum Size {
    /// Any number of characters.
    Batch,
    /// Known.
    Fixed(usize),
}

/// A graph that grows.
#[derive(Default)]
pub(super) struct GraphBuilder {
    graph: GraphProto,
}

impl GraphBuilder {
    /// A graph with the input [`OBSERVATION`] of so many numbers for each character.
    pub(super) fn new(name: &str, observation_len: usize) -> Self {
        let mut builder = Self::default();
        name.clone_into(&mut builder.graph.name);
        builder.input(OBSERVATION, [Size::Batch, Size::Fixed(observation_len)]);
        builder
    }

    pub(super) fn input(&mut self, name: &str, shape: [Size; 2]) {
        self.graph.input.push(value(name, shape));
    }

    /// A constant of real numbers. Returns its name.
    pub(super) fn floats(&mut self, name: impl Into<String>, shape: &[usize], numbers: &[f32]) -> String {
        let raw_data = numbers.iter().flat_map(|n| n.to_le_bytes()).collect();
        self.constant(name.into(), shape, FLOAT, raw_data)
    }

    /// A vector of integers. Returns its name.
    pub(super) fn integers(&mut self, name: impl Into<String>, numbers: &[usize]) -> String {
        let raw_data = numbers.iter().flat_map(|n| (*n as i64).to_le_bytes()).collect();
        self.constant(name.into(), &[numbers.len()], INT64, raw_data)
    }

    fn constant(&mut self, name: String, shape: &[usize], data_type: i32, raw_data: Vec<u8>) -> String {
        let dims = shape.iter().map(|size| *size as i64).collect();
        let tensor = TensorProto { dims, data_type, name: name.clone(), raw_data, ..TensorProto::default() };
        self.graph.initializer.push(tensor);
        name
    }

    /// An operator. Returns the name of its output.
    pub(super) fn node(&mut self, op_type: &str, inputs: &[&str], output: impl Into<String>) -> String {
        let output = output.into();
        self.graph.node.push(NodeProto {
            input: inputs.iter().map(|input| (*input).to_owned()).collect(),
            output: vec![output.clone()],
            name: format!("make_{output}"),
            op_type: op_type.to_owned(),
            attribute: Vec::new(),
        });
        output
    }

    /// Gives the last operator an integer constant.
    pub(super) fn attribute(&mut self, name: &str, i: i64) {
        let attribute =
            AttributeProto { name: name.to_owned(), i: Some(i), r#type: ATTRIBUTE_INT, ..Default::default() };
        // Called right after `node`, by the exporter only.
        self.graph.node.last_mut().expect("an operator was added before").attribute.push(attribute);
    }

    /// The bytes of a file whose output is `output`, one row for each character.
    pub(super) fn finish(mut self, output: &str, width: usize, doc: &str) -> Vec<u8> {
        self.graph.output.push(value(output, [Size::Batch, Size::Fixed(width)]));
        let model = ModelProto {
            ir_version: IR_VERSION,
            producer_name: "policy-space".to_owned(),
            producer_version: env!("CARGO_PKG_VERSION").to_owned(),
            doc_string: doc.to_owned(),
            graph: Some(self.graph),
            opset_import: vec![OperatorSetIdProto { domain: String::new(), version: OPSET }],
        };
        model.encode_to_vec()
    }
}

fn value(name: &str, shape: [Size; 2]) -> ValueInfoProto {
    let dim = shape.map(|size| match size {
        Size::Batch => Dimension { dim_param: Some("batch".to_owned()), dim_value: None },
        Size::Fixed(size) => Dimension { dim_value: Some(size as i64), dim_param: None },
    });
    let tensor = TensorType { elem_type: FLOAT, shape: Some(TensorShapeProto { dim: dim.into() }) };
    ValueInfoProto { name: name.to_owned(), r#type: Some(TypeProto { tensor_type: Some(tensor) }) }
}

impl TensorProto {
    /// The real numbers of a tensor; `None` when there are not as many as its shape says or they are of another type.
    #[must_use]
    pub fn floats(&self) -> Option<Vec<f32>> {
        let count = self.dims.iter().try_fold(1_usize, |count, size| {
            count.checked_mul(usize::try_from(*size).ok()?).filter(|count| *count <= MOST_ELEMENTS)
        })?;
        let (inside, float) = (self.data_location == 0, self.data_type == FLOAT);
        let (raw, rest) = self.raw_data.as_chunks();
        let numbers: Vec<f32> = match self.float_data.is_empty() {
            true => raw.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect(),
            false => self.float_data.clone(),
        };
        (inside && float && rest.is_empty() && numbers.len() == count).then_some(numbers)
    }

    /// The integers of a tensor, under the same conditions.
    #[must_use]
    pub fn integers(&self) -> Option<Vec<i64>> {
        let (raw, rest) = self.raw_data.as_chunks();
        let sound = self.data_location == 0 && self.data_type == INT64 && rest.is_empty();
        sound.then(|| raw.iter().map(|bytes| i64::from_le_bytes(*bytes)).collect())
    }
}
