//! Hyper-parameters of PPO.

use serde::{Deserialize, Serialize};

/// Hyper-parameters of PPO. Every field has the default of the recipe that worked.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PpoConfig {
    /// Discount of a reward one tick later. 0.95 is enough for style, 0.98 for staying upright.
    pub gamma: f32,
    /// Discount of generalised advantage estimation (Schulman et al. 2016).
    pub gae_lambda: f32,
    /// How far the ratio of probabilities may leave 1 before its gradient stops.
    pub clip: f32,
    /// Passes over a rollout.
    pub epochs: usize,
    /// Rows of one gradient step.
    pub minibatch: usize,
    /// Fixed standard deviation of every action.
    pub deviation: f32,
    /// Divergence from the acting policy that the actor's rate is steered to.
    pub target_kl: f32,
    /// First rate of the actor's Adam.
    pub actor_rate: f32,
    /// Least rate of the actor's Adam.
    pub least_actor_rate: f32,
    /// Largest rate of the actor's Adam.
    pub most_actor_rate: f32,
    /// Rate of the critic's Adam.
    pub critic_rate: f32,
    /// Largest norm of either gradient.
    pub gradient_norm: f32,
    /// Weight of the squared excess of |mean action| over 1.
    pub bound_penalty: f32,
    /// Share that a policy's running mean keeps at every update.
    pub average: f32,
    /// Weight of the squared distance to the guiding actions of a rollout, where it has any.
    #[serde(skip)]
    pub guide: f32,
    /// Weight of the squared distance to the parent's parameters.
    pub regularisation: f32,
    /// Hidden sizes of the critic.
    pub critic_hidden: Vec<usize>,
}

impl Default for PpoConfig {
    fn default() -> Self {
        Self {
            gamma: 0.98,
            gae_lambda: 0.95,
            clip: 0.2,
            epochs: 4,
            minibatch: 2048,
            deviation: 0.06,
            target_kl: 0.02,
            actor_rate: 1e-4,
            least_actor_rate: 2e-5,
            most_actor_rate: 1e-3,
            critic_rate: 5e-4,
            gradient_norm: 1.0,
            bound_penalty: 10.0,
            average: 0.99,
            guide: 0.0,
            regularisation: 0.0,
            critic_hidden: vec![256, 128],
        }
    }
}
