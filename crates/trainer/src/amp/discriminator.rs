//! A discriminator that learns beside the policy, and the style reward it gives.

use random::Rng;
use rayon::prelude::*;

use super::config::{DiscriminatorConfig, GRADIENT_PENALTY, LEARNING_RATE, REPLAY_ROWS, WEIGHT_DECAY};
use super::noise::NoiseTable;
use super::replay::Replay;
use crate::env::Demonstrations;
use crate::nn::{Adam, DiscriminatorLoss, DiscriminatorPass, Network, sigmoid};
use crate::ppo::BatchEvaluator;

/// `-ln(max(1 - sigmoid(logit), 1e-4))`: 0 for what is surely simulated, 9.2 for what is surely a demonstration; 0 for no number.
#[must_use]
pub fn style_reward(logit: f32) -> f32 {
    if logit.is_nan() {
        return 0.0;
    }
    -(1.0 - sigmoid(logit)).max(1e-4).ln()
}

/// Means over the rows of one iteration's gradient steps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DiscriminatorReport {
    /// Cross-entropy of a row.
    pub cross_entropy: f32,
    /// Share of rows told apart rightly.
    pub accuracy: f32,
    /// Squared gradient at a demonstration.
    pub squared_gradient: f32,
}

/// One share of a gradient step.
#[derive(Clone, Debug)]
struct Lane {
    pass: DiscriminatorPass,
    input: Vec<f32>,
    gradient: Vec<f32>,
    loss: DiscriminatorLoss,
}

const LANES: usize = 2;

/// A discriminator, its optimiser, its replay and its buffers.
#[derive(Clone, Debug)]
pub struct DiscriminatorLearner {
    /// Hyper-parameters.
    pub config: DiscriminatorConfig,
    /// The network: normalised inputs, one logit.
    pub network: Network,
    /// Its optimiser.
    pub adam: Adam,
    /// Draws rows and noise.
    pub rng: Rng,
    replay: Replay,
    noise: NoiseTable,
    lanes: Vec<Lane>,
    batch: BatchEvaluator,
}

impl DiscriminatorLearner {
    /// A learner that starts from `network`, or from random parameters for so many inputs.
    #[must_use]
    pub fn new(
        config: DiscriminatorConfig,
        inputs: usize,
        network: Option<Network>,
        seed: u64,
        stream: u64,
    ) -> Self {
        let mut rng = Rng::new(seed, stream);
        let network = network.unwrap_or_else(|| {
            let mut sizes = vec![inputs];
            sizes.extend_from_slice(&config.hidden);
            sizes.push(1);
            Network::new(&sizes, 1.0, &mut rng)
        });
        let inputs = network.inputs();
        let rows = config.batch.div_ceil(LANES);
        let lane = Lane {
            pass: DiscriminatorPass::new(network.sizes(), rows),
            input: vec![0.0; 2 * rows * inputs],
            gradient: vec![0.0; network.parameters.len()],
            loss: DiscriminatorLoss::default(),
        };
        Self {
            adam: Adam::new(network.parameters.len()),
            replay: Replay::new(config.replay_size, inputs),
            noise: NoiseTable::new(seed),
            lanes: vec![lane; LANES],
            batch: BatchEvaluator::new(network.sizes()),
            config,
            network,
            rng,
        }
    }

    /// Writes the logit of every row of `inputs`.
    pub fn logits_into(&mut self, inputs: &[f32], logits: &mut [f32]) {
        self.batch.evaluate(&self.network, None, inputs, logits);
    }

    /// Learns to tell `demonstrations` from the rows of `inputs` that `chosen` lists, and from those it remembers.
    ///
    /// Does nothing when no row was ever chosen.
    pub fn update(
        &mut self,
        demonstrations: &Demonstrations,
        inputs: &[f32],
        chosen: &[u32],
    ) -> DiscriminatorReport {
        let width = self.network.inputs();
        let row_of = |row: u32| &inputs[row as usize * width..(row as usize + 1) * width];
        if !chosen.is_empty() {
            for _ in 0..REPLAY_ROWS {
                let row = row_of(chosen[self.rng.index(chosen.len())]);
                self.replay.push(row);
            }
        }
        let mut report = DiscriminatorReport::default();
        if self.replay.is_empty() {
            return report;
        }
        let per_lane = self.config.batch.div_ceil(LANES);
        let scale = 1.0 / (per_lane * LANES) as f32;
        for _ in 0..self.config.updates {
            self.fill_lanes(demonstrations, inputs, chosen);
            let network = &self.network;
            self.lanes.par_iter_mut().for_each(|lane| {
                lane.gradient.fill(0.0);
                lane.loss =
                    lane.pass.accumulate(network, &lane.input, GRADIENT_PENALTY, scale, &mut lane.gradient);
            });
            let (first, others) = self.lanes.split_first_mut().expect("there are lanes");
            for lane in others {
                first.gradient.iter_mut().zip(&lane.gradient).for_each(|(a, b)| *a += b);
                first.loss.cross_entropy += lane.loss.cross_entropy;
                first.loss.squared_gradient += lane.loss.squared_gradient;
                first.loss.right += lane.loss.right;
            }
            let parameters = &mut self.network.parameters;
            self.adam.step(parameters, &first.gradient, LEARNING_RATE, WEIGHT_DECAY);
            let each = f64::from(scale) / self.config.updates as f64;
            report.cross_entropy += (first.loss.cross_entropy * 0.5 * each) as f32;
            report.accuracy += (first.loss.right * 0.5 * each) as f32;
            report.squared_gradient += (first.loss.squared_gradient * each) as f32;
        }
        report
    }

    /// Fills the lanes of a gradient step: demonstrations, then rows of this rollout and of earlier ones by turns, with noise.
    fn fill_lanes(&mut self, demonstrations: &Demonstrations, inputs: &[f32], chosen: &[u32]) {
        let width = self.network.inputs();
        let per_lane = self.config.batch.div_ceil(LANES);
        let row_of = |row: u32| &inputs[row as usize * width..(row as usize + 1) * width];
        for lane in &mut self.lanes {
            let (real, simulated) = lane.input.split_at_mut(per_lane * width);
            for row in real.chunks_exact_mut(width) {
                demonstrations.sample_into(&mut self.rng, row);
                self.noise.add(&mut self.rng, self.config.noise_std, row);
            }
            for (i, row) in simulated.chunks_exact_mut(width).enumerate() {
                let fresh = i % 2 == 0 && !chosen.is_empty();
                let from = if fresh {
                    row_of(chosen[self.rng.index(chosen.len())])
                } else {
                    self.replay.draw(&mut self.rng)
                };
                row.copy_from_slice(from);
                self.noise.add(&mut self.rng, self.config.noise_std, row);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn style_grows_with_the_logit_and_is_bounded() {
        assert!((style_reward(0.0) - core::f32::consts::LN_2).abs() < 1e-6);
        assert!(style_reward(-50.0).abs() < 1e-6);
        assert!((style_reward(50.0) - 9.21034).abs() < 1e-3);
        assert_eq!(style_reward(f32::NAN), 0.0);
    }
}
