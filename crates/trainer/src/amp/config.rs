//! Hyper-parameters of a discriminator.

use serde::{Deserialize, Serialize};

/// Hyper-parameters of a discriminator. Every field has the default of the recipe that worked.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DiscriminatorConfig {
    /// Hidden sizes.
    pub hidden: Vec<usize>,
    /// Rate of its Adam.
    pub rate: f32,
    /// Weight decay, as a share of the rate.
    pub decay: f32,
    /// Weight of the squared gradient at the demonstrations.
    pub gradient_penalty: f32,
    /// Gradient steps an iteration.
    pub updates: usize,
    /// Demonstrations of one gradient step, and as many simulated rows.
    pub rows: usize,
    /// Deviation of the noise on its inputs while it learns.
    pub noise: f32,
    /// Simulated rows kept.
    pub replay: usize,
    /// Simulated rows taken up an iteration.
    pub replay_rows: usize,
}

impl Default for DiscriminatorConfig {
    fn default() -> Self {
        Self {
            hidden: vec![512, 256],
            rate: 1e-4,
            decay: 0.01,
            gradient_penalty: 10.0,
            updates: 4,
            rows: 256,
            noise: 0.1,
            replay: 100_000,
            replay_rows: 1000,
        }
    }
}
