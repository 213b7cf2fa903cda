//! Proximal policy optimisation (Schulman et al. 2017) as four verbs: [`Learner::act`], [`Rollout::record`],
//! [`Learner::compute_returns`], [`Learner::update`]. Knows nothing of characters, clips or styles.
//!
//! One thing is beyond the paper: policies are trained along the straight lines between them, each row acting with its own
//! blend of the two ends of an edge; either end may be frozen. A symmetry loss (Yu, Turk, Liu 2018) can pull the mean action in a
//! mirrored state to the mirror image of the mean action.

mod batch;
mod config;
mod gaussian;
mod lane;
mod learner;
mod mirror;
mod rollout;
mod update;

pub use batch::BatchEvaluator;
pub use config::{
    BOUND_PENALTY, CLIP, CRITIC_LEARNING_RATE, EMA_DECAY, GAE_LAMBDA, MAX_GRAD_NORM, PpoConfig,
};
pub use gaussian::{kl_divergence, log_probability};
pub use learner::{Actor, Learner};
pub use mirror::{Mirror, SignedPermutation};
pub use rollout::{Done, Rollout};
pub use update::UpdateReport;
