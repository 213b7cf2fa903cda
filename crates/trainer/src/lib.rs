//! Trains the policies of the graph: adversarial motion priors and PPO, with every skill pulled towards its parent.

pub mod amp;
pub mod average;
pub mod checkpoint;
pub mod env;
pub mod lineage;
pub mod nn;
pub mod normaliser_file;
pub mod onnx;
pub mod pack;
mod parts;
pub mod plot;
pub mod posture;
pub mod ppo;
pub mod recipe;
pub mod run;
pub mod search;
pub mod style;
pub mod toml_file;
pub mod training;
pub mod workspace;

pub use random::Rng;
