//! Why models can't be written or read.

use std::path::PathBuf;

/// Why models can't be written or read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OnnxError {
    /// A file can't be read or written.
    #[error("{}: {error}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        error: std::io::Error,
    },
    /// The deployment file is not as this library writes it.
    #[error("{}: expected a deployment file, found {found}", path.display())]
    Deployment {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        found: String,
    },
    /// The bytes are no ONNX model.
    #[error("model of {policy}: expected an ONNX model, found {found}")]
    Model {
        /// Name of the policy.
        policy: String,
        /// What is wrong.
        found: String,
    },
    /// The graph is not that of a policy.
    #[error("model of {policy}: expected {expected}, found {found}")]
    Graph {
        /// Name of the policy.
        policy: String,
        /// What a policy's graph has.
        expected: String,
        /// What is there.
        found: String,
    },
    /// The models differ in their normaliser, so they could not be blended.
    #[error("expected one normaliser for all policies, found another in the model of {policy}")]
    Normaliser {
        /// Name of the first policy that differs.
        policy: String,
    },
    /// The pack has a policy that the models lack, or the other way round.
    #[error("expected models of the pack's policies {expected:?}, found {found:?}")]
    Policies {
        /// Names in the pack.
        expected: Vec<String>,
        /// Names in the deployment file.
        found: Vec<String>,
    },
    /// The pack refuses the policies.
    #[error("policies that the pack takes: {0}")]
    Pack(#[from] policy_core::PackError),
}
