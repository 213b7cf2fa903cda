//! burn on its own processor back end, flex, with automatic differentiation and its Adam.
//!
//! Its graph is used up by one backward pass and gradients carry none, so a second derivative is not to be had; the
//! penalty's input gradient is written out as the product of masked layers that it is for ReLU.

use anyhow::{Context, Result, anyhow};
use burn::optim::{Adam, AdamConfig, AdamState, Optimizer};
use burn::tensor::activation::relu;
use burn::tensor::module::linear;
use burn::tensor::{Device, Tensor, TensorData};

use super::Learner;
use super::job::{Job, Loss};

/// The layers, the batch and the optimiser.
pub struct Burn {
    layers: Vec<Layer>,
    optimiser: Adam,
    input: Tensor<2>,
    numbers: Tensor<2>,
    loss: Loss,
    scale: f32,
}

/// Parameters and their moments.
struct Layer {
    weight: Tensor<2>,
    bias: Tensor<1>,
    weight_moments: Option<AdamState<2>>,
    bias_moments: Option<AdamState<1>>,
}

impl Burn {
    /// Copies the network and the batch.
    pub fn new(job: &Job) -> Self {
        let device = Device::flex().autodiff();
        let matrix = |values: &[f32], columns: usize| {
            let data = TensorData::new(values.to_vec(), [values.len() / columns, columns]);
            Tensor::<2>::from_data(data, &device)
        };
        let layers = job.network.layers().into_iter().map(|layer| {
            let bias = TensorData::new(job.network.parameters[layer.bias].to_vec(), [layer.outputs]);
            Layer {
                weight: matrix(&job.network.parameters[layer.weight], layer.outputs).require_grad(),
                bias: Tensor::<1>::from_data(bias, &device).require_grad(),
                weight_moments: None,
                bias_moments: None,
            }
        });
        Self {
            layers: layers.collect(),
            optimiser: AdamConfig::new().with_epsilon(1e-8).build(),
            input: matrix(&job.input, job.network.inputs()),
            numbers: matrix(&job.numbers, job.network.outputs()),
            loss: job.loss,
            scale: job.scale(),
        }
    }

    fn loss(&self) -> Tensor<1> {
        let mut flow = self.input.clone();
        let mut hidden = Vec::new();
        for (index, layer) in self.layers.iter().enumerate() {
            flow = linear(flow, layer.weight.clone(), Some(layer.bias.clone()));
            if index + 1 < self.layers.len() {
                flow = relu(flow);
                hidden.push(flow.clone());
            }
        }
        let numbers = self.numbers.clone();
        match self.loss {
            Loss::Squared => (flow - numbers).square().sum() * (0.5 * self.scale),
            Loss::Linear => (flow * numbers).sum() * self.scale,
            Loss::CrossEntropy => cross_entropy(flow, numbers) * self.scale,
            Loss::PenalisedCrossEntropy => {
                let squared = self.squared_input_gradient(&hidden);
                (cross_entropy(flow, numbers) + squared * Loss::PENALTY) * self.scale
            }
        }
    }

    /// Summed over the first half of the rows.
    fn squared_input_gradient(&self, hidden: &[Tensor<2>]) -> Tensor<1> {
        let mut chain = self.layers[self.layers.len() - 1].weight.clone().transpose();
        for (layer, hidden) in self.layers.iter().zip(hidden).rev() {
            let demonstrations = hidden.dims()[0] / 2;
            let active = hidden.clone().detach().slice([0..demonstrations]).greater_elem(0.0).float();
            chain = (chain * active).matmul(layer.weight.clone().transpose());
        }
        chain.square().sum()
    }
}

/// Of logits with labels, summed.
fn cross_entropy(logits: Tensor<2>, labels: Tensor<2>) -> Tensor<1> {
    let tail = logits.clone().abs().neg().exp().log1p();
    (relu(logits.clone()) - logits * labels + tail).sum()
}

fn numbers<const D: usize>(tensor: Tensor<D>) -> Result<Vec<f32>> {
    tensor.into_data().try_to_vec::<f32>().map_err(|error| anyhow!("{error:?}"))
}

impl Learner for Burn {
    fn loss_and_gradient(&mut self) -> Result<(f32, Vec<f32>)> {
        let loss = self.loss();
        let gradients = loss.backward();
        let mut flat = Vec::new();
        for layer in &self.layers {
            flat.extend(numbers(layer.weight.grad(&gradients).context("expected a gradient, found none")?)?);
            flat.extend(numbers(layer.bias.grad(&gradients).context("expected a gradient, found none")?)?);
        }
        Ok((loss.into_scalar(), flat))
    }

    fn step(&mut self) -> Result<()> {
        let mut gradients = self.loss().backward();
        let rate = f64::from(Job::RATE);
        for layer in std::mem::take(&mut self.layers) {
            let Layer { weight, bias, weight_moments, bias_moments } = layer;
            let gradient = weight.grad_remove(&mut gradients).context("expected a gradient, found none")?;
            let (weight, weight_moments) =
                self.optimiser.step(rate, weight.inner(), gradient, weight_moments);
            let gradient = bias.grad_remove(&mut gradients).context("expected a gradient, found none")?;
            let (bias, bias_moments) = self.optimiser.step(rate, bias.inner(), gradient, bias_moments);
            let (weight, bias) = (weight.autodiff().require_grad(), bias.autodiff().require_grad());
            self.layers.push(Layer { weight, bias, weight_moments, bias_moments });
        }
        Ok(())
    }

    fn parameters(&self) -> Result<Vec<f32>> {
        let mut flat = Vec::new();
        for layer in &self.layers {
            flat.extend(numbers(layer.weight.clone())?);
            flat.extend(numbers(layer.bias.clone())?);
        }
        Ok(flat)
    }
}
