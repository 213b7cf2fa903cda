//! Policies as ONNX models, and back. Opset 13: Gemm and Relu, elementwise operators for the normaliser.
//!
//! Each policy becomes one model with the normaliser inside. Each path becomes one model that takes blend weights beside the
//! observation and blends the parameters inside. A deployment file says what else an engine must know. What is exported and
//! imported again has the same bits.

mod deployment;
mod error;
mod export;
mod graph;
mod import;
mod proto;

pub use deployment::{DEPLOYMENT_FILE, Deployment};
pub use error::OnnxError;
pub use export::{export, path_model, policy_model};
pub use import::{ImportedPolicy, import, read_policy};
pub use proto::{
    AttributeProto, Dimension, GraphProto, ModelProto, NodeProto, TensorProto, TensorShapeProto, TensorType,
    TypeProto, ValueInfoProto,
};

/// Version of the operators.
pub const OPSET: i64 = 13;

/// Name of the input that holds raw observation and target: `[batch, policy_input_len]`.
pub const OBSERVATION: &str = "observation";

/// Name of the input that holds blend weights: `[layers, nodes of the path]`.
pub const BLEND: &str = "blend";

/// Name of the output: `[batch, joints]`.
pub const ACTION: &str = "action";
