//! Checkpoints: safetensors files with all that a run needs to continue, and no more.
//!
//! The states of the characters are not kept: a resumed run starts new episodes.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use safetensors::tensor::{Dtype, SafeTensors, TensorView};
use serde::{Deserialize, Serialize};

use crate::Rng;
use crate::nn::{Adam, Network};
use crate::storage::{read_bounded, write_atomically, write_keeping_previous};

/// Version of the checkpoint format. Version 1 called [`EMA`] `average` and had no checksums; it still loads.
const FORMAT: u32 = 2;

/// Role of a policy that learns.
pub const ACTOR: &str = "actor";

/// Role of a policy's exponential moving average.
pub const EMA: &str = "ema";

/// [`EMA`] in version 1.
const EMA_OF_VERSION_1: &str = "average";

/// Role of a discriminator.
pub const DISCRIMINATOR: &str = "discriminator";

/// Role of the discriminator of a parent's style.
pub const PARENT_DISCRIMINATOR: &str = "parent_discriminator";

/// Role of the critic.
pub const CRITIC: &str = "critic";

/// Largest checkpoint, bytes.
pub const MOST_BYTES: u64 = 1 << 30;

/// Most networks of a checkpoint.
const MOST_NETWORKS: usize = 256;

/// Most layers of a network, and most units of a layer.
const MOST_LAYERS: usize = 16;
const MOST_UNITS: usize = 1 << 14;

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
    /// The learner's random numbers.
    pub rng: Rng,
    sizes: HashMap<String, (Vec<usize>, u64)>,
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
        let progress = Progress { format: FORMAT, seed, samples, secs, learning_rate, rng, sizes, checksums };
        Self { networks, progress }
    }

    /// The checkpoint without the optimisers' moments, with the moving averages of the policies in their place.
    ///
    /// It has a third of the size. Training continues from it after a few iterations in which Adam finds its pace.
    #[must_use]
    pub fn slim(mut self) -> Self {
        self.networks.remove(PARENT_DISCRIMINATOR);
        let averages: Vec<String> = self.networks.keys().filter(|r| r.ends_with(EMA)).cloned().collect();
        for role in averages {
            let actor = format!("{}{ACTOR}", role.strip_suffix(EMA).unwrap_or_default());
            self.networks.remove(&role).and_then(|average| self.networks.insert(actor, average));
        }
        for trained in self.networks.values_mut() {
            trained.adam = Adam { mean: Vec::new(), square: Vec::new(), steps: 0 };
        }
        let p = &self.progress;
        Self::new(self.networks, (p.seed, p.samples, p.secs), p.learning_rate, p.rng)
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

    fn to_bytes(&self) -> std::io::Result<Vec<u8>> {
        let parts = |role: &String, t: &Trained| {
            let all = [
                (format!("{role}.parameters"), bytes(&t.network.parameters)),
                (format!("{role}.mean"), bytes(&t.adam.mean)),
                (format!("{role}.square"), bytes(&t.adam.square)),
            ];
            all.into_iter().filter(|(_, data)| !data.is_empty())
        };
        let tensors: Vec<(String, Vec<u8>)> =
            self.networks.iter().flat_map(|(role, t)| parts(role, t)).collect();
        let checksums = tensors.iter().map(|(name, data)| (name.clone(), crc32fast::hash(data))).collect();
        let progress = Progress { checksums, ..self.progress.clone() };
        let views = tensors.iter().map(|(name, data)| {
            let view = TensorView::new(Dtype::F32, vec![data.len() / 4], data);
            (name, view.expect("four bytes for each number"))
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
        read(&data).map_err(|Wrong { expected, found }| CheckpointError::Content {
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

/// What a file should hold and what it holds.
struct Wrong {
    expected: String,
    found: String,
}

fn wrong(expected: impl Into<String>, found: impl Into<String>) -> Wrong {
    Wrong { expected: expected.into(), found: found.into() }
}

/// Parses the bytes of a checkpoint. Nothing is allocated before its size is compared with that of the file.
fn read(data: &[u8]) -> Result<Checkpoint, Wrong> {
    let not_safe = |e: safetensors::SafeTensorError| wrong("a whole safetensors file", e.to_string());
    let (_, meta) = SafeTensors::read_metadata(data).map_err(not_safe)?;
    let text = meta.metadata().as_ref().and_then(|m| m.get("progress"));
    let text = text.ok_or_else(|| wrong("metadata `progress`", "none"))?;
    let progress: Progress =
        serde_json::from_str(text).map_err(|e| wrong("metadata `progress`", e.to_string()))?;
    if !(1..=FORMAT).contains(&progress.format) {
        return Err(wrong(format!("format 1 to {FORMAT}"), progress.format.to_string()));
    }
    if !(progress.learning_rate.is_finite() && progress.learning_rate > 0.0 && progress.secs >= 0.0) {
        let found = format!("{} and {}", progress.learning_rate, progress.secs);
        return Err(wrong("a positive learning rate and seconds of at least 0", found));
    }
    if progress.sizes.len() > MOST_NETWORKS {
        return Err(wrong(format!("at most {MOST_NETWORKS} networks"), progress.sizes.len().to_string()));
    }
    let tensors = SafeTensors::deserialize(data).map_err(not_safe)?;
    let mut networks = HashMap::new();
    for (role, (sizes, steps)) in &progress.sizes {
        let trained = read_network(role, sizes, *steps, &tensors, &progress.checksums)?;
        networks.insert(present_role(role), trained);
    }
    let p = &progress;
    Ok(Checkpoint::new(networks, (p.seed, p.samples, p.secs), p.learning_rate, p.rng))
}

/// Today's name of a role.
fn present_role(role: &str) -> String {
    match role.strip_suffix(EMA_OF_VERSION_1) {
        Some(before) if before.is_empty() || before.ends_with('.') => format!("{before}{EMA}"),
        _ => role.to_owned(),
    }
}

fn read_network(
    role: &str,
    sizes: &[usize],
    steps: u64,
    tensors: &SafeTensors<'_>,
    checksums: &HashMap<String, u32>,
) -> Result<Trained, Wrong> {
    let layers = 2..=MOST_LAYERS;
    if !layers.contains(&sizes.len()) || sizes.iter().any(|s| *s == 0 || *s > MOST_UNITS) {
        let expected = format!("2 to {MOST_LAYERS} sizes of 1 to {MOST_UNITS} for {role}");
        return Err(wrong(expected, format!("{} sizes, the largest {:?}", sizes.len(), sizes.iter().max())));
    }
    // At most 15 layers of 2^28 parameters: no overflow.
    let count = Network::parameter_count(sizes);
    let read = |part: &str| {
        let name = format!("{role}.{part}");
        let view = tensors.tensor(&name).map_err(|e| wrong(format!("tensor {name}"), e.to_string()))?;
        if checksums.get(&name).is_some_and(|sum| *sum != crc32fast::hash(view.data())) {
            return Err(wrong(format!("the written bytes in {name}"), "others"));
        }
        let expected = format!("{count} finite numbers in {name}");
        floats(&view, count).ok_or_else(|| wrong(expected, format!("shape {:?}", view.shape())))
    };
    let parameters = read("parameters")?;
    let mut network = Network::zeros(sizes);
    network.parameters = parameters;
    let adam = match steps {
        0 => Adam::new(count),
        steps => Adam { mean: read("mean")?, square: read("square")?, steps },
    };
    Ok(Trained { network, adam })
}

/// Little-endian bytes of single-precision numbers.
#[must_use]
pub fn bytes(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

/// The numbers of a tensor, if they are `count` finite single-precision ones.
#[must_use]
pub fn floats(view: &TensorView<'_>, count: usize) -> Option<Vec<f32>> {
    if view.dtype() != Dtype::F32 || view.data().len() != 4 * count {
        return None;
    }
    let word = |b: &[u8]| f32::from_le_bytes([b[0], b[1], b[2], b[3]]);
    let values: Vec<f32> = view.data().chunks_exact(4).map(word).collect();
    values.iter().all(|v| v.is_finite()).then_some(values)
}

#[cfg(test)]
#[path = "checkpoint_tests.rs"]
mod tests;
