//! tract: the same ONNX model, optimised for a fixed shape.

use anyhow::Result;
use tract_onnx::prelude::*;

use super::network::{Network, OBSERVATION_LEN};
use super::{Peer, onnx};

/// A state that is run again and again.
pub struct Tract {
    state: TypedSimpleState,
}

impl Tract {
    /// Takes the network over.
    ///
    /// # Errors
    /// When the model is refused.
    pub fn new(network: &Network) -> Result<Self> {
        let plan = tract_onnx::onnx()
            .model_for_read(&mut onnx::model(network).as_slice())?
            .into_optimized()?
            .into_runnable()?;
        Ok(Self { state: plan.spawn()? })
    }
}

impl Peer for Tract {
    fn evaluate_into(&mut self, observation: &[f32], action: &mut [f32]) -> Result<()> {
        let input = Tensor::from_shape(&[1, OBSERVATION_LEN], observation)?;
        let outputs = self.state.run(tvec!(input.into()))?;
        action.copy_from_slice(outputs[0].try_as_plain_ram()?.as_slice::<f32>()?);
        Ok(())
    }
}
