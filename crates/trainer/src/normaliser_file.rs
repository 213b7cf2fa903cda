//! The file that holds the normalisers of the whole graph, written once and read by every run.

use std::path::Path;

use files::quoted;
use files::{read_bounded, write_atomically};
use policy_core::Skeleton;
use policy_core::training::Normaliser;
use safetensors::tensor::{Dtype, SafeTensors, TensorView};

use crate::checkpoint::{CheckpointError, bytes, floats};
use crate::env::Normalisers;

const NAMES: [&str; 2] = ["observation", "discriminator"];

/// Largest file, bytes.
const MOST_BYTES: u64 = 1 << 20;

/// Reads means and deviations of observations and discriminator frames of a skeleton.
///
/// # Errors
/// When the file can't be read or doesn't hold them.
pub fn load(path: &Path, skeleton: &Skeleton) -> Result<Normalisers, CheckpointError> {
    let data = read_bounded(path, MOST_BYTES)
        .map_err(|source| CheckpointError::Io { path: path.to_owned(), source })?;
    let wrong = |expected: String, found: String| {
        let found = quoted(&found);
        CheckpointError::Content { path: path.to_owned(), expected, found }
    };
    let tensors =
        SafeTensors::deserialize(&data).map_err(|e| wrong("a safetensors file".into(), e.to_string()))?;
    let read = |name: &str, len: usize| {
        let part = |part: &str| {
            let name = format!("{name}.{part}");
            let view = tensors.tensor(&name).map_err(|e| wrong(format!("tensor {name}"), e.to_string()))?;
            floats(&view, len).ok_or_else(|| {
                wrong(format!("{len} finite numbers in {name}"), format!("{:?}", view.shape()))
            })
        };
        Normaliser::from_mean_and_deviation(&part("mean")?, &part("deviation")?)
            .map_err(|e| wrong(format!("a normaliser {name}"), e.to_string()))
    };
    let [observation, frame] = NAMES;
    Ok(Normalisers {
        observation: read(observation, skeleton.observation_len())?,
        frame: read(frame, skeleton.frame_len())?,
    })
}

/// Writes the file.
///
/// # Errors
/// When it can't be written.
pub fn save(path: &Path, normalisers: &Normalisers) -> Result<(), CheckpointError> {
    let io = |source| CheckpointError::Io { path: path.to_owned(), source };
    let mut tensors = Vec::new();
    for (name, n) in NAMES.iter().zip([&normalisers.observation, &normalisers.frame]) {
        tensors.push((format!("{name}.mean"), bytes(n.mean())));
        tensors.push((format!("{name}.deviation"), bytes(n.deviation())));
    }
    let views = tensors.iter().map(|(name, data)| {
        let view = TensorView::new(Dtype::F32, vec![data.len() / 4], data);
        (name, view.expect("four bytes for each number"))
    });
    let data = safetensors::serialize(views, None).map_err(|e| io(std::io::Error::other(e.to_string())))?;
    write_atomically(path, &data).map_err(io)
}
