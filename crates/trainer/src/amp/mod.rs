//! Adversarial motion priors (Peng et al. 2021): a thin layer over PPO that scores style.

mod config;
mod discriminator;
mod noise;
mod replay;

pub use config::DiscriminatorConfig;
pub use discriminator::{DiscriminatorLearner, DiscriminatorReport, style_reward};
pub use replay::Replay;
