//! Hyper-parameters of a discriminator. What no recipe changes is a constant.

use serde::{Deserialize, Serialize};

/// Learning rate.
pub const LEARNING_RATE: f32 = 1e-4;

/// Weight decay, as a share of the learning rate.
pub const WEIGHT_DECAY: f32 = 0.01;

/// Weight of the squared gradient at the demonstrations.
pub const GRADIENT_PENALTY: f32 = 10.0;

/// Simulated rows that enter the replay buffer in an iteration.
pub const REPLAY_ROWS: usize = 1000;

/// Hyper-parameters of a discriminator. The defaults are those of the recipe that worked.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DiscriminatorConfig {
    /// Hidden sizes.
    pub hidden: Vec<usize>,
    /// Gradient steps an iteration.
    pub updates: usize,
    /// Demonstrations of one gradient step, and as many simulated rows.
    pub batch: usize,
    /// Standard deviation of the noise on its inputs while it learns.
    pub noise_std: f32,
    /// Rows of the replay buffer.
    pub replay_size: usize,
}

impl Default for DiscriminatorConfig {
    fn default() -> Self {
        Self { hidden: vec![512, 256], updates: 4, batch: 256, noise_std: 0.1, replay_size: 100_000 }
    }
}
