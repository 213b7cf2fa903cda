//! Proximal policy optimisation (Schulman et al. 2017) as four verbs: [`Learner::act`], [`Rollout::record`],
//! [`Learner::compute_returns`], [`Learner::update`]. Knows nothing of characters, clips or styles.
//!
//! One thing is beyond the paper: a child may be trained along the whole straight line from a frozen parent, each row
//! acting with its own blend weight.

mod config;
mod gaussian;
mod learner;
mod rollout;
mod update;

pub use config::PpoConfig;
pub use gaussian::{kl_divergence, log_probability};
pub use learner::{BatchEvaluator, Learner};
pub use rollout::{Done, Rollout};
pub use update::UpdateReport;
