//! Checkpoints: safetensors files written whole or not at all, with everything a run needs to go on.
//!
//! The characters' places are not kept: a run that is resumed starts new episodes.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use safetensors::tensor::{Dtype, SafeTensors, TensorView};
use serde::{Deserialize, Serialize};

use crate::Rng;
use crate::nn::{Adam, Network};
use crate::training::{AVERAGE, PARENT_DISCRIMINATOR};

/// Version of the checkpoint format.
const FORMAT: u32 = 1;

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
    /// Rate of the actors' Adam, their geometric mean.
    pub actor_rate: f32,
    /// The learner's random numbers.
    pub rng: Rng,
    sizes: HashMap<String, (Vec<usize>, u64)>,
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
        actor_rate: f32,
        rng: Rng,
    ) -> Self {
        let sizes = networks
            .iter()
            .map(|(role, t)| (role.clone(), (t.network.sizes().to_vec(), t.adam.steps)))
            .collect();
        Self { networks, progress: Progress { format: FORMAT, seed, samples, secs, actor_rate, rng, sizes } }
    }

    /// The checkpoint without the optimisers' moments, with the running means of policies in their place: a third of its
    /// size, enough to go on from, after a few iterations of finding its pace again.
    #[must_use]
    pub fn slim(mut self) -> Self {
        self.networks.remove(PARENT_DISCRIMINATOR);
        let means: Vec<String> = self.networks.keys().filter(|r| r.ends_with(AVERAGE)).cloned().collect();
        for role in means {
            let actor = format!("{}actor", role.strip_suffix(AVERAGE).unwrap_or_default());
            self.networks.remove(&role).and_then(|mean| self.networks.insert(actor, mean));
        }
        for trained in self.networks.values_mut() {
            trained.adam = Adam { mean: Vec::new(), square: Vec::new(), steps: 0 };
        }
        let p = &self.progress;
        Self::new(self.networks, (p.seed, p.samples, p.secs), p.actor_rate, p.rng)
    }

    /// Writes the file beside its place and moves it there.
    ///
    /// # Errors
    /// When it can't be written.
    pub fn save(&self, path: &Path) -> Result<(), CheckpointError> {
        let io = |source| CheckpointError::Io { path: path.to_owned(), source };
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
        let views = tensors.iter().map(|(name, data)| {
            let view = TensorView::new(Dtype::F32, vec![data.len() / 4], data);
            (name, view.expect("four bytes for each number"))
        });
        let progress = serde_json::to_string(&self.progress).expect("plain numbers can be written");
        let meta = [("progress".to_owned(), progress)].into_iter().collect();
        let data = safetensors::serialize(views, Some(meta))
            .map_err(|e| io(std::io::Error::other(e.to_string())))?;
        write_atomically(path, &data).map_err(io)
    }

    /// Reads a file that [`Checkpoint::save`] wrote.
    ///
    /// # Errors
    /// When it can't be read, or is not such a file.
    pub fn load(path: &Path) -> Result<Self, CheckpointError> {
        let data =
            std::fs::read(path).map_err(|source| CheckpointError::Io { path: path.to_owned(), source })?;
        let wrong = |expected: &str, found: String| CheckpointError::Content {
            path: path.to_owned(),
            expected: expected.into(),
            found,
        };
        let not_safe = |e: safetensors::SafeTensorError| wrong("a safetensors file", e.to_string());
        let (_, meta) = SafeTensors::read_metadata(&data).map_err(not_safe)?;
        let text = meta.metadata().as_ref().and_then(|m| m.get("progress"));
        let text = text.ok_or_else(|| wrong("metadata `progress`", "none".into()))?;
        let progress: Progress =
            serde_json::from_str(text).map_err(|e| wrong("metadata `progress`", e.to_string()))?;
        if progress.format != FORMAT {
            return Err(wrong("format 1", progress.format.to_string()));
        }
        let tensors = SafeTensors::deserialize(&data).map_err(not_safe)?;
        let mut networks = HashMap::new();
        for (role, (sizes, steps)) in &progress.sizes {
            if sizes.len() < 2 || sizes.iter().any(|s| *s == 0 || *s > 1 << 14) {
                return Err(wrong("sizes of a network", format!("{sizes:?} for {role}")));
            }
            let mut network = Network::zeros(sizes);
            let count = network.parameters.len();
            let read = |part: &str| {
                let name = format!("{role}.{part}");
                let view =
                    tensors.tensor(&name).map_err(|e| wrong(&format!("tensor {name}"), e.to_string()))?;
                floats(&view, count).ok_or_else(|| {
                    wrong(&format!("{count} finite numbers in {name}"), format!("{:?}", view.shape()))
                })
            };
            network.parameters = read("parameters")?;
            let adam = match *steps {
                0 => Adam::new(count),
                steps => Adam { mean: read("mean")?, square: read("square")?, steps },
            };
            networks.insert(role.clone(), Trained { network, adam });
        }
        Ok(Self { networks, progress })
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

/// Writes a file so that it is there whole or not at all.
///
/// # Errors
/// When the folder can't be written.
pub fn write_atomically(path: &Path, data: &[u8]) -> std::io::Result<()> {
    let beside = path.with_extension("partial");
    std::fs::write(&beside, data)?;
    std::fs::rename(&beside, path)
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
