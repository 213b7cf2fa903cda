//! Hyper-parameters of PPO. What no recipe changes is a constant.

use serde::{Deserialize, Serialize};

/// Discount of generalised advantage estimation (Schulman et al. 2016).
pub const GAE_LAMBDA: f32 = 0.95;

/// How far the ratio of probabilities may leave 1 before its gradient stops.
pub const CLIP: f32 = 0.2;

/// Learning rate of the critic.
pub const CRITIC_LEARNING_RATE: f32 = 5e-4;

/// Largest norm of the gradient of an actor or the critic.
pub const MAX_GRAD_NORM: f32 = 1.0;

/// Weight of the squared excess of |mean action| over 1.
pub const BOUND_PENALTY: f32 = 10.0;

/// Share that a policy's exponential moving average keeps at every update.
pub const EMA_DECAY: f32 = 0.99;

/// Hyper-parameters of PPO. The defaults are those of the recipe that worked.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PpoConfig {
    /// Discount of a reward one tick later. 0.95 is enough for style, 0.98 for staying upright.
    pub gamma: f32,
    /// Passes over a rollout.
    pub epochs: usize,
    /// Rows of one gradient step.
    pub minibatch: usize,
    /// Fixed standard deviation of every action, in units of the action range.
    pub action_std: f32,
    /// KL divergence from the acting policy that the actors' learning rates are adapted to.
    pub target_kl: f32,
    /// First learning rate of the actors in a run, and in a phase whose rate is another than that of the phase before.
    pub learning_rate: f32,
    /// Least learning rate of the actors.
    pub min_learning_rate: f32,
    /// Largest learning rate of the actors.
    pub max_learning_rate: f32,
    /// Behaviour-cloning weight: that of the squared distance between the mean action and the one that tracks the clip. Above
    /// zero the learning rates stay at their largest value.
    pub behaviour_cloning: f32,
    /// Weight of the squared distance to the parent's parameters.
    pub regularisation: f32,
    /// Weight of the symmetry loss: the squared distance between the mean action and the mirror image of the mean action in the
    /// mirrored state (Yu, Turk, Liu 2018). It takes the name of each body and hinge with `left` for `right` to be its mirror image.
    pub symmetry: f32,
    /// Learns the mean of the policy that the phase began with and of its mirror image, by behaviour cloning on its own rollouts, and nothing
    /// from rewards. The learning rate stays at its largest value. Needs a symmetry loss, which cares for the mirrored states.
    pub symmetrise: bool,
    /// Hidden sizes of the critic.
    pub critic_hidden: Vec<usize>,
}

impl PpoConfig {
    /// Weight of the squared distance between the mean action and the target of behaviour cloning.
    #[must_use]
    pub fn cloning_weight(&self) -> f32 {
        if self.symmetrise { 1.0 } else { self.behaviour_cloning }
    }
}

impl Default for PpoConfig {
    fn default() -> Self {
        Self {
            gamma: 0.98,
            epochs: 4,
            minibatch: 2048,
            action_std: 0.06,
            target_kl: 0.02,
            learning_rate: 1e-4,
            min_learning_rate: 2e-5,
            max_learning_rate: 1e-3,
            behaviour_cloning: 0.0,
            regularisation: 0.0,
            symmetry: 0.0,
            symmetrise: false,
            critic_hidden: vec![256, 128],
        }
    }
}
