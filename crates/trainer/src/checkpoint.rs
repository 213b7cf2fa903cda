//! Checkpoints: safetensors files with all that a run needs to continue, and no more.
//!
//! The states of the characters are not kept: a resumed run starts new episodes.

use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};

use files::{read_bounded, write_atomically, write_keeping_previous};
use random::Rng;
use safetensors::tensor::{Dtype, TensorView};
use serde::{Deserialize, Serialize};

use crate::nn::{Adam, Network};

mod numbers;
mod read;

pub use numbers::{bytes, floats, half_bytes};
use read::{Wrong, read};

/// Version of the checkpoint format. Version 1 called [`EMA`] `average` and had no checksums; it still loads.
const FORMAT: u32 = 2;

/// Role of a policy that learns.
pub const ACTOR: &str = "actor";

/// Role of a policy's exponential moving average.
pub const EMA: &str = "ema";

/// Role of a discriminator.
pub const DISCRIMINATOR: &str = "discriminator";

/// Role of the discriminator of a parent's style.
pub const PARENT_DISCRIMINATOR: &str = "parent_discriminator";

/// Role of the policy whose symmetric mean is learned.
pub const TEACHER: &str = "teacher";

/// Role of the critic.
pub const CRITIC: &str = "critic";

/// Largest checkpoint, bytes.
pub const MOST_BYTES: u64 = 240 << 20;

/// Most parameters of all networks of a checkpoint. With their moments, and the file beside them, reading takes less than
/// 500 MB.
pub const MOST_PARAMETERS: usize = 20_000_000;

/// Why a checkpoint can't be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// The file can't be read or written.
    #[error("cannot use {}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// It is no checkpoint, or one of another shape.
    #[error("{}: expected {expected}, found {found}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// What should be there.
        expected: String,
        /// What is there.
        found: String,
    },
}

/// A network with its optimiser.
#[derive(Clone, Debug, PartialEq)]
pub struct Trained {
    /// Its parameters.
    pub network: Network,
    /// Its moments.
    pub adam: Adam,
}

/// Numbers beside the tensors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Progress {
    format: u32,
    /// Seed of the run.
    pub seed: u64,
    /// Samples taken.
    pub samples: u64,
    /// Wall-clock seconds of training.
    pub secs: f64,
    /// Learning rate of the actors, their geometric mean.
    #[serde(alias = "actor_rate")]
    pub learning_rate: f32,
    /// Learning rate of each actor by its role. Those that are missing have the mean, as in old checkpoints.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub learning_rates: BTreeMap<String, f32>,
    /// The learner's random numbers.
    pub rng: Rng,
    sizes: HashMap<String, (Vec<usize>, u64)>,
    /// True when discriminators are written in half precision.
    #[serde(skip)]
    halves: bool,
    /// CRC-32 of every tensor.
    #[serde(default, skip_serializing_if = "HashMap::is_empty")]
    checksums: HashMap<String, u32>,
}

/// State of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint {
    /// Networks by role, see [`Training::networks_mut`](crate::training::Training::networks_mut).
    pub networks: HashMap<String, Trained>,
    /// The rest.
    pub progress: Progress,
}

impl Checkpoint {
    /// A checkpoint of these networks.
    #[must_use]
    pub fn new(
        networks: HashMap<String, Trained>,
        (seed, samples, secs): (u64, u64, f64),
        learning_rate: f32,
        rng: Rng,
    ) -> Self {
        let sizes = networks
            .iter()
            .map(|(role, t)| (role.clone(), (t.network.sizes().to_vec(), t.adam.steps)))
            .collect();
        let checksums = HashMap::new();
        let progress = Progress {
            format: FORMAT,
            seed,
            samples,
            secs,
            learning_rate,
            learning_rates: BTreeMap::new(),
            rng,
            sizes,
            halves: false,
            checksums,
        };
        Self { networks, progress }
    }

    /// The checkpoint without the optimisers' moments, with the moving averages of the policies in their place.
    ///
    /// Discriminators are written in half precision: they adapt to the policies in any case. The file has a fifth of the size.
    /// Training continues from it after a few iterations in which Adam finds its pace.
    #[must_use]
    pub fn slim(mut self) -> Self {
        self.networks.remove(PARENT_DISCRIMINATOR);
        self.networks.remove(TEACHER);
        let averages: Vec<String> = self.networks.keys().filter(|r| r.ends_with(EMA)).cloned().collect();
        for role in averages {
            let actor = format!("{}{ACTOR}", role.strip_suffix(EMA).unwrap_or_default());
            self.networks.remove(&role).and_then(|average| self.networks.insert(actor, average));
        }
        for trained in self.networks.values_mut() {
            trained.adam = Adam { mean: Vec::new(), square: Vec::new(), steps: 0 };
        }
        let p = &self.progress;
        let mut slim = Self::new(self.networks, (p.seed, p.samples, p.secs), p.learning_rate, p.rng);
        slim.progress.learning_rates = self.progress.learning_rates;
        slim.progress.halves = true;
        slim
    }

    /// Writes the file, whole or not at all.
    ///
    /// # Errors
    /// When it can't be written.
    pub fn save(&self, path: &Path) -> Result<(), CheckpointError> {
        let io = |source| CheckpointError::Io { path: path.to_owned(), source };
        write_atomically(path, &self.to_bytes().map_err(io)?).map_err(io)
    }

    /// As [`Checkpoint::save`]; the file that was there becomes `previous`.
    ///
    /// # Errors
    /// As [`Checkpoint::save`].
    pub fn save_keeping_previous(&self, path: &Path, previous: &Path) -> Result<(), CheckpointError> {
        let io = |source| CheckpointError::Io { path: path.to_owned(), source };
        write_keeping_previous(path, previous, &self.to_bytes().map_err(io)?).map_err(io)
    }

    /// The bytes of a file.
    ///
    /// # Errors
    /// When a name or a size does not fit into the format, or the networks have more than [`MOST_PARAMETERS`].
    pub fn to_bytes(&self) -> std::io::Result<Vec<u8>> {
        let parameters = self.networks.values().map(|t| t.network.parameters.len()).sum();
        if parameters > MOST_PARAMETERS {
            return Err(std::io::Error::other(too_many(parameters)));
        }
        let parts = |role: &String, t: &Trained| {
            let all =
                [("parameters", &t.network.parameters), ("mean", &t.adam.mean), ("square", &t.adam.square)];
            let halved = self.progress.halves && role.ends_with(DISCRIMINATOR);
            let written = move |(part, values): (&str, &Vec<f32>)| match halved {
                true => (format!("{role}.{part}"), Dtype::F16, half_bytes(values)),
                false => (format!("{role}.{part}"), Dtype::F32, bytes(values)),
            };
            all.map(written).into_iter().filter(|(.., data)| !data.is_empty())
        };
        let tensors: Vec<(String, Dtype, Vec<u8>)> =
            self.networks.iter().flat_map(|(role, t)| parts(role, t)).collect();
        let checksums = tensors.iter().map(|(name, _, data)| (name.clone(), crc32fast::hash(data))).collect();
        let progress = Progress { checksums, ..self.progress.clone() };
        let views = tensors.iter().map(|(name, dtype, data)| {
            let bytes = if *dtype == Dtype::F16 { 2 } else { 4 };
            let view = TensorView::new(*dtype, vec![data.len() / bytes], data);
            (name, view.expect("as many bytes as the type has for each number"))
        });
        let progress = serde_json::to_string(&progress).expect("plain numbers can be written");
        let meta = [("progress".to_owned(), progress)].into_iter().collect();
        safetensors::serialize(views, Some(meta)).map_err(|e| std::io::Error::other(e.to_string()))
    }

    /// Reads a file that [`Checkpoint::save`] wrote.
    ///
    /// # Errors
    /// When it can't be read, is larger than [`MOST_BYTES`], or is no whole checkpoint.
    pub fn load(path: &Path) -> Result<Self, CheckpointError> {
        let data = read_bounded(path, MOST_BYTES)
            .map_err(|source| CheckpointError::Io { path: path.to_owned(), source })?;
        Self::from_bytes(path, &data)
    }

    /// Reads the bytes of a file; `path` is only named in errors.
    ///
    /// # Errors
    /// When they are no whole checkpoint.
    pub fn from_bytes(path: &Path, data: &[u8]) -> Result<Self, CheckpointError> {
        read(data).map_err(|Wrong { expected, found }| CheckpointError::Content {
            path: path.to_owned(),
            expected,
            found,
        })
    }

    /// The network of this role.
    ///
    /// # Errors
    /// When there is none; `path` is named in the error.
    pub fn network(&self, role: &str, path: &Path) -> Result<&Trained, CheckpointError> {
        self.networks.get(role).ok_or_else(|| CheckpointError::Content {
            path: path.to_owned(),
            expected: format!("a network `{role}`"),
            found: "none".into(),
        })
    }
}

fn too_many(parameters: usize) -> String {
    format!("expected at most {MOST_PARAMETERS} parameters in all networks, found {parameters}")
}

#[cfg(test)]
#[path = "checkpoint_tests.rs"]
mod tests;
