//! Trains the policies of the graph: adversarial motion priors and PPO, with every skill pulled towards its parent.

pub mod nn;
mod rng;

pub use rng::{NoiseTable, Rng};
