//! The trainer's own networks, in lanes as its PPO and its discriminator use them.

use anyhow::Result;
use rayon::prelude::*;
use trainer::nn::{Adam, DiscriminatorPass, Network, Pass, sigmoid, softplus};

use super::Learner;
use super::job::{Job, Loss};

/// A network, its moments and its lanes.
pub struct Own {
    network: Network,
    adam: Adam,
    lanes: Vec<Lane>,
    loss: Loss,
    scale: f32,
}

/// One share of the batch.
struct Lane {
    pass: Pass,
    penalised: DiscriminatorPass,
    input: Vec<f32>,
    numbers: Vec<f32>,
    gradient: Vec<f32>,
    sum: f64,
}

impl Own {
    /// Copies the network and splits the batch.
    pub fn new(job: &Job) -> Self {
        Self {
            network: job.network.clone(),
            adam: Adam::new(job.network.parameters.len()),
            lanes: (0..job.lanes).map(|index| Lane::new(job, index)).collect(),
            loss: job.loss,
            scale: job.scale(),
        }
    }

    /// Leaves the whole gradient in the first lane.
    fn accumulate(&mut self) {
        let (network, loss, scale) = (&self.network, self.loss, self.scale);
        self.lanes.par_iter_mut().for_each(|lane| lane.accumulate(network, loss, scale));
        let (first, others) = self.lanes.split_first_mut().expect("a job has a lane");
        for lane in others {
            first.gradient.iter_mut().zip(&lane.gradient).for_each(|(sum, g)| *sum += g);
            first.sum += lane.sum;
        }
    }
}

impl Learner for Own {
    fn loss_and_gradient(&mut self) -> Result<(f32, Vec<f32>)> {
        self.accumulate();
        Ok(((self.lanes[0].sum * f64::from(self.scale)) as f32, self.lanes[0].gradient.clone()))
    }

    fn step(&mut self) -> Result<()> {
        self.accumulate();
        self.adam.step(&mut self.network.parameters, &self.lanes[0].gradient, Job::RATE, 0.0);
        Ok(())
    }

    fn parameters(&self) -> Result<Vec<f32>> {
        Ok(self.network.parameters.clone())
    }
}

impl Lane {
    /// The same share of the first half of the rows and of the second: as many demonstrations as simulated rows.
    fn new(job: &Job, index: usize) -> Self {
        let (sizes, half) = (job.network.sizes(), job.rows() / 2);
        let share = half / job.lanes;
        assert_eq!(share * job.lanes * 2, job.rows(), "lanes of equal length");
        let (mut input, mut numbers) = (Vec::new(), Vec::new());
        for first in [index * share, half + index * share] {
            let rows = |columns: usize| first * columns..(first + share) * columns;
            input.extend_from_slice(&job.input[rows(job.network.inputs())]);
            numbers.extend_from_slice(&job.numbers[rows(job.network.outputs())]);
        }
        Self {
            pass: Pass::new(sizes, 2 * share),
            penalised: DiscriminatorPass::new(sizes, share),
            input,
            numbers,
            gradient: vec![0.0; job.network.parameters.len()],
            sum: 0.0,
        }
    }

    fn accumulate(&mut self, network: &Network, loss: Loss, scale: f32) {
        self.gradient.fill(0.0);
        self.sum = 0.0;
        if loss == Loss::PenalisedCrossEntropy {
            let (input, gradient) = (&self.input, &mut self.gradient);
            let sums = self.penalised.accumulate(network, input, Loss::PENALTY, scale, gradient);
            self.sum = sums.cross_entropy + f64::from(Loss::PENALTY) * sums.squared_gradient;
            return;
        }
        self.pass.forward(network, None, &self.input);
        let (outputs, deltas) = self.pass.output_and_delta(self.input.len() / network.inputs());
        for ((y, n), delta) in outputs.iter().zip(&self.numbers).zip(deltas) {
            let (loss, slope) = match loss {
                Loss::Squared => (0.5 * (y - n) * (y - n), y - n),
                Loss::Linear => (y * n, *n),
                _ => (softplus(*y) - n * y, sigmoid(*y) - n),
            };
            self.sum += f64::from(loss);
            *delta = slope * scale;
        }
        self.pass.backward(network, None, &self.input, &mut self.gradient, None);
    }
}
