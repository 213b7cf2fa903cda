//! ONNX Runtime, through ort. The library itself is the one that `ORT_DYLIB_PATH` names.

use anyhow::{Context, Result};
use ort::environment::Environment;
use ort::session::Session;
use ort::session::builder::GraphOptimizationLevel;
use ort::value::TensorRef;

use super::network::{Network, OBSERVATION_LEN};
use super::{Peer, onnx};

/// One session, one thread, all graph optimisations.
pub struct OnnxRuntime {
    session: Session,
    _environment: Environment,
}

impl OnnxRuntime {
    /// Loads the library and the network.
    ///
    /// # Errors
    /// When `ORT_DYLIB_PATH` names no library or it does not take the network.
    pub fn new(network: &Network) -> Result<Self> {
        let path =
            std::env::var("ORT_DYLIB_PATH").context("ORT_DYLIB_PATH; `cargo xtask bench policy` sets it")?;
        let environment = ort::init_from(path)?.with_telemetry(false).build()?;
        let session = Self::session(&environment, network)?;
        Ok(Self { session, _environment: environment })
    }

    fn session(environment: &Environment, network: &Network) -> ort::Result<Session> {
        Session::builder(environment)?
            .with_intra_threads(1)?
            .with_inter_threads(1)?
            .with_optimization_level(GraphOptimizationLevel::Level3)?
            .commit_from_memory(&onnx::model(network))
    }
}

impl Peer for OnnxRuntime {
    fn evaluate_into(&mut self, observation: &[f32], action: &mut [f32]) -> Result<()> {
        let input = TensorRef::from_array_view(([1, OBSERVATION_LEN], observation))?;
        let outputs = self.session.run(ort::inputs![input])?;
        let (_, numbers) = outputs[0].try_extract_tensor::<f32>()?;
        action.copy_from_slice(numbers);
        Ok(())
    }
}
