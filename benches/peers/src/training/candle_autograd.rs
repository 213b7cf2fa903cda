//! candle on the processor: `Var`s, `backward`, and AdamW of candle-nn without decay.
//!
//! Unless told otherwise it detaches gradients from the graph, so there is no second derivative; the penalty's input
//! gradient is written out as the product of masked layers that it is for ReLU, which needs a first derivative only.

use anyhow::{Context, Result};
use candle_core::{DType, Device, Tensor, Var};
use candle_nn::loss::binary_cross_entropy_with_logit;
use candle_nn::{AdamW, Optimizer, ParamsAdamW};

use super::Learner;
use super::job::{Job, Loss};

/// The layers as weight and bias, the batch, and the optimiser.
pub struct Candle {
    layers: Vec<(Var, Var)>,
    optimiser: AdamW,
    input: Tensor,
    numbers: Tensor,
    loss: Loss,
    scale: f64,
    rows: usize,
}

impl Candle {
    /// Copies the network and the batch.
    ///
    /// # Errors
    /// When a tensor cannot be made.
    pub fn new(job: &Job) -> Result<Self> {
        let mut layers = Vec::new();
        for layer in job.network.layers() {
            let (weight, bias) = (&job.network.parameters[layer.weight], &job.network.parameters[layer.bias]);
            layers.push((
                Var::from_slice(weight, (layer.inputs, layer.outputs), &Device::Cpu)?,
                Var::from_slice(bias, layer.outputs, &Device::Cpu)?,
            ));
        }
        let variables = layers.iter().flat_map(|(weight, bias)| [weight.clone(), bias.clone()]).collect();
        let rate = f64::from(Job::RATE);
        let parameters = ParamsAdamW { lr: rate, weight_decay: 0.0, ..ParamsAdamW::default() };
        let rows = job.rows();
        Ok(Self {
            layers,
            optimiser: AdamW::new(variables, parameters)?,
            input: Tensor::from_slice(&job.input, (rows, job.network.inputs()), &Device::Cpu)?,
            numbers: Tensor::from_slice(&job.numbers, (rows, job.network.outputs()), &Device::Cpu)?,
            loss: job.loss,
            scale: f64::from(job.scale()),
            rows,
        })
    }

    fn loss(&self) -> Result<Tensor> {
        let mut flow = self.input.clone();
        let mut hidden = Vec::new();
        for (index, (weight, bias)) in self.layers.iter().enumerate() {
            flow = flow.matmul(weight)?.broadcast_add(bias)?;
            if index + 1 < self.layers.len() {
                flow = flow.relu()?;
                hidden.push(flow.clone());
            }
        }
        let cross_entropy = |flow: &Tensor| -> Result<Tensor> {
            let mean = binary_cross_entropy_with_logit(flow, &self.numbers)?;
            Ok((mean * (self.rows as f64 * self.scale))?)
        };
        Ok(match self.loss {
            Loss::Squared => ((flow - &self.numbers)?.sqr()?.sum_all()? * (0.5 * self.scale))?,
            Loss::Linear => ((flow * &self.numbers)?.sum_all()? * self.scale)?,
            Loss::CrossEntropy => cross_entropy(&flow)?,
            Loss::PenalisedCrossEntropy => {
                let squared = self.squared_input_gradient(&hidden)?;
                (cross_entropy(&flow)? + (squared * (f64::from(Loss::PENALTY) * self.scale))?)?
            }
        })
    }

    /// Summed over the first half of the rows.
    fn squared_input_gradient(&self, hidden: &[Tensor]) -> Result<Tensor> {
        let (last, _) = self.layers.last().context("a network has layers")?;
        let mut chain = last.t()?;
        for ((weight, _), hidden) in self.layers.iter().zip(hidden).rev() {
            let active = hidden.narrow(0, 0, self.rows / 2)?.detach().gt(0f32)?.to_dtype(DType::F32)?;
            chain = chain.broadcast_mul(&active)?.matmul(&weight.t()?)?;
        }
        Ok(chain.sqr()?.sum_all()?)
    }
}

impl Learner for Candle {
    fn loss_and_gradient(&mut self) -> Result<(f32, Vec<f32>)> {
        let loss = self.loss()?;
        let gradients = loss.backward()?;
        let mut flat = Vec::new();
        for variable in self.layers.iter().flat_map(|(weight, bias)| [weight, bias]) {
            let gradient = gradients.get(variable).context("expected a gradient, found none")?;
            flat.extend(gradient.flatten_all()?.to_vec1::<f32>()?);
        }
        Ok((loss.to_scalar()?, flat))
    }

    fn step(&mut self) -> Result<()> {
        let loss = self.loss()?;
        self.optimiser.backward_step(&loss)?;
        Ok(())
    }

    fn parameters(&self) -> Result<Vec<f32>> {
        let mut flat = Vec::new();
        for variable in self.layers.iter().flat_map(|(weight, bias)| [weight, bias]) {
            flat.extend(variable.flatten_all()?.to_vec1::<f32>()?);
        }
        Ok(flat)
    }
}
