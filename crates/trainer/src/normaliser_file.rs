//! The file that holds the normalisers of the whole graph, written once and read by every run.

use std::path::Path;

use policy_core::{FRAME_LEN, Normaliser, OBSERVATION_LEN};
use safetensors::tensor::{Dtype, SafeTensors, TensorView};

use crate::checkpoint::{CheckpointError, bytes, floats};
use crate::env::Normalisers;
use crate::storage::{read_bounded, write_atomically};

const NAMES: [(&str, usize); 2] = [("observation", OBSERVATION_LEN), ("discriminator", FRAME_LEN)];

/// Largest file, bytes.
const MOST_BYTES: u64 = 1 << 20;

/// Reads means and deviations of observations and discriminator frames.
///
/// # Errors
/// When the file can't be read or doesn't hold them.
pub fn load(path: &Path) -> Result<Normalisers, CheckpointError> {
    let data = read_bounded(path, MOST_BYTES)
        .map_err(|source| CheckpointError::Io { path: path.to_owned(), source })?;
    let wrong =
        |expected: String, found: String| CheckpointError::Content { path: path.to_owned(), expected, found };
    let tensors =
        SafeTensors::deserialize(&data).map_err(|e| wrong("a safetensors file".into(), e.to_string()))?;
    let read = |(name, len): (&str, usize)| {
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
    Ok(Normalisers { observation: read(NAMES[0])?, frame: read(NAMES[1])? })
}

/// Writes the file.
///
/// # Errors
/// When it can't be written.
pub fn save(path: &Path, normalisers: &Normalisers) -> Result<(), CheckpointError> {
    let io = |source| CheckpointError::Io { path: path.to_owned(), source };
    let mut tensors = Vec::new();
    for ((name, _), n) in NAMES.iter().zip([&normalisers.observation, &normalisers.frame]) {
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
