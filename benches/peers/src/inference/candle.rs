//! candle on the processor: matrix product, broadcast sum, ReLU.

use anyhow::Result;
use candle_core::{Device, Tensor};

use super::Peer;
use super::network::Network;

/// The layers as weight and bias.
pub struct Candle {
    layers: Vec<(Tensor, Tensor)>,
}

impl Candle {
    /// Takes the network over.
    ///
    /// # Errors
    /// When a tensor cannot be made.
    pub fn new(network: &Network) -> Result<Self> {
        let mut layers = Vec::new();
        for layer in &network.layers {
            let weight = Tensor::from_slice(&layer.weight, (layer.inputs, layer.outputs), &Device::Cpu)?;
            let bias = Tensor::from_slice(&layer.bias, (1, layer.outputs), &Device::Cpu)?;
            layers.push((weight, bias));
        }
        Ok(Self { layers })
    }
}

impl Peer for Candle {
    fn evaluate_into(&mut self, observation: &[f32], action: &mut [f32]) -> Result<()> {
        let mut flow = Tensor::from_slice(observation, (1, observation.len()), &Device::Cpu)?;
        for (index, (weight, bias)) in self.layers.iter().enumerate() {
            flow = (flow.matmul(weight)? + bias)?;
            if index + 1 < self.layers.len() {
                flow = flow.relu()?;
            }
        }
        action.copy_from_slice(&flow.flatten_all()?.to_vec1::<f32>()?);
        Ok(())
    }
}
