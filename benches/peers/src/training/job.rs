//! The gradient steps to take: the sizes and batches of the recipes, with made-up numbers.

use trainer::Rng;
use trainer::nn::Network;

/// What is made small. Sums over the rows, times [`Job::scale`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Loss {
    /// Half the squared difference to the job's numbers: the critic's.
    Squared,
    /// Product with the job's numbers: any gradient that is known by the output, such as the policy's.
    Linear,
    /// Cross-entropy of logits with the job's numbers as labels.
    CrossEntropy,
    /// The same and ten times the squared gradient by the input at the first half of the rows, the demonstrations.
    PenalisedCrossEntropy,
}

impl Loss {
    /// Weight of the squared gradient.
    pub const PENALTY: f32 = 10.0;
}

/// A network, a batch and a loss.
#[derive(Debug, Clone)]
pub struct Job {
    /// Name in the figures.
    pub name: &'static str,
    /// The network at the start.
    pub network: Network,
    /// `[rows][inputs]`.
    pub input: Vec<f32>,
    /// Targets, coefficients or labels, `[rows][outputs]`.
    pub numbers: Vec<f32>,
    /// What is made small.
    pub loss: Loss,
    /// Into how many lanes the trainer splits such a batch.
    pub lanes: usize,
}

impl Job {
    /// Adam's rate: so small that the network stays much the same however often it is measured.
    pub const RATE: f32 = 1e-5;

    /// Rows of the batch.
    pub fn rows(&self) -> usize {
        self.input.len() / self.network.inputs()
    }

    /// What sums over the rows are multiplied by: one row's share, or one demonstration's.
    pub fn scale(&self) -> f32 {
        let counted = match self.loss {
            Loss::Squared | Loss::Linear => self.rows(),
            Loss::CrossEntropy | Loss::PenalisedCrossEntropy => self.rows() / 2,
        };
        1.0 / counted as f32
    }

    fn new(name: &'static str, sizes: &[usize], rows: usize, loss: Loss, lanes: usize) -> Self {
        let mut rng = Rng::new(7, 0);
        let network = Network::new(sizes, 1.0, &mut rng);
        let input = (0..rows * network.inputs()).map(|_| rng.normal()).collect();
        let count = rows * network.outputs();
        let numbers = match loss {
            Loss::Squared | Loss::Linear => (0..count).map(|_| rng.normal()).collect(),
            _ => (0..count).map(|row| if row < count / 2 { 1.0 } else { 0.0 }).collect(),
        };
        Self { name, network, input, numbers, loss, lanes }
    }
}

/// The recipe's gradient steps: critic, actor, and the discriminator without and with its gradient penalty.
pub fn jobs() -> Vec<Job> {
    let discriminator = [625, 512, 256, 1];
    vec![
        Job::new("critic", &[226, 256, 128, 1], 2048, Loss::Squared, 4),
        Job::new("actor", &[225, 128, 32, 28], 2048, Loss::Linear, 4),
        Job::new("discriminator", &discriminator, 512, Loss::CrossEntropy, 2),
        Job::new("discriminator_with_penalty", &discriminator, 512, Loss::PenalisedCrossEntropy, 2),
    ]
}
