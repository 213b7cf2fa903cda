//! Trains the policies of the graph: adversarial motion priors and PPO, with every skill pulled towards its parent.

pub mod amp;
pub mod average;
pub mod checkpoint;
pub mod clip;
pub mod compare;
pub mod env;
pub mod evaluate;
pub mod limp;
pub mod lineage;
pub mod nn;
pub mod normaliser_file;
pub mod onnx;
pub mod pack;
mod parts;
pub mod pca;
pub mod plot;
pub mod ppo;
pub mod recipe;
mod rng;
pub mod run;
pub mod storage;
pub mod strip;
pub mod style;
pub mod text;
pub mod training;
pub mod workspace;

pub use rng::{NoiseTable, Rng};
