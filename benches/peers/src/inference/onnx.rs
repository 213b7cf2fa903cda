//! The network as an ONNX model: per layer a `Gemm`, and a `Relu` after all but the last.

use prost::Message;
use tract_onnx::pb::{
    GraphProto, ModelProto, NodeProto, OperatorSetIdProto, TensorProto, TensorShapeProto, TypeProto,
    ValueInfoProto, tensor_proto, tensor_shape_proto, type_proto,
};

use super::network::{ACTION_LEN, Network, OBSERVATION_LEN};

/// The model's bytes: input `observation` of shape [1, 225], output `action` of shape [1, 28].
pub fn model(network: &Network) -> Vec<u8> {
    let mut graph = GraphProto {
        name: "policy".to_owned(),
        input: vec![matrix("observation", OBSERVATION_LEN)],
        output: vec![matrix("action", ACTION_LEN)],
        ..Default::default()
    };
    let last = network.layers.len() - 1;
    let mut flows_in = "observation".to_owned();
    for (index, layer) in network.layers.iter().enumerate() {
        let (weight, bias) = (format!("weight{index}"), format!("bias{index}"));
        graph.initializer.push(tensor(&weight, &[layer.inputs, layer.outputs], &layer.weight));
        graph.initializer.push(tensor(&bias, &[layer.outputs], &layer.bias));
        let sum = if index == last { "action".to_owned() } else { format!("sum{index}") };
        graph.node.push(node("Gemm", &[&flows_in, &weight, &bias], &sum));
        flows_in = sum;
        if index < last {
            let hidden = format!("hidden{index}");
            graph.node.push(node("Relu", &[&flows_in], &hidden));
            flows_in = hidden;
        }
    }
    let opset = OperatorSetIdProto { domain: String::new(), version: 17 };
    let model =
        ModelProto { ir_version: 8, opset_import: vec![opset], graph: Some(graph), ..Default::default() };
    model.encode_to_vec()
}

fn node(op_type: &str, inputs: &[&str], output: &str) -> NodeProto {
    NodeProto {
        name: format!("make_{output}"),
        op_type: op_type.to_owned(),
        input: inputs.iter().map(|input| (*input).to_owned()).collect(),
        output: vec![output.to_owned()],
        ..Default::default()
    }
}

fn tensor(name: &str, shape: &[usize], numbers: &[f32]) -> TensorProto {
    TensorProto {
        name: name.to_owned(),
        dims: shape.iter().map(|&size| size as i64).collect(),
        data_type: tensor_proto::DataType::Float as i32,
        float_data: numbers.to_vec(),
        ..Default::default()
    }
}

/// A matrix with one row.
fn matrix(name: &str, columns: usize) -> ValueInfoProto {
    let dimension = |size: usize| tensor_shape_proto::Dimension {
        value: Some(tensor_shape_proto::dimension::Value::DimValue(size as i64)),
        ..Default::default()
    };
    let shape = TensorShapeProto { dim: vec![dimension(1), dimension(columns)] };
    let elem_type = tensor_proto::DataType::Float as i32;
    let value = type_proto::Value::TensorType(type_proto::Tensor { elem_type, shape: Some(shape) });
    ValueInfoProto {
        name: name.to_owned(),
        r#type: Some(TypeProto { value: Some(value), ..Default::default() }),
        ..Default::default()
    }
}
