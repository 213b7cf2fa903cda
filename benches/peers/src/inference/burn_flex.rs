//! burn on its own processor back end, flex: matrix product, sum, ReLU.

use anyhow::{Result, anyhow};
use burn::tensor::activation::relu;
use burn::tensor::{Device, Tensor, TensorData};

use super::Peer;
use super::network::Network;

/// The layers as weight and bias.
pub struct BurnFlex {
    layers: Vec<(Tensor<2>, Tensor<2>)>,
    device: Device,
}

impl BurnFlex {
    /// Takes the network over.
    pub fn new(network: &Network) -> Self {
        let device = Device::flex();
        let layers = network.layers.iter().map(|layer| {
            let weight = TensorData::new(layer.weight.clone(), [layer.inputs, layer.outputs]);
            let bias = TensorData::new(layer.bias.clone(), [1, layer.outputs]);
            (Tensor::from_data(weight, &device), Tensor::from_data(bias, &device))
        });
        Self { layers: layers.collect(), device }
    }
}

impl Peer for BurnFlex {
    fn evaluate_into(&mut self, observation: &[f32], action: &mut [f32]) -> Result<()> {
        let data = TensorData::new(observation.to_vec(), [1, observation.len()]);
        let mut flow: Tensor<2> = Tensor::from_data(data, &self.device);
        for (index, (weight, bias)) in self.layers.iter().enumerate() {
            flow = flow.matmul(weight.clone()) + bias.clone();
            if index + 1 < self.layers.len() {
                flow = relu(flow);
            }
        }
        let data = flow.into_data();
        action.copy_from_slice(data.as_slice::<f32>().map_err(|error| anyhow!("{error:?}"))?);
        Ok(())
    }
}
