//! Reading checkpoints of any version. Nothing is allocated before its size is compared with that of the file.

use std::collections::HashMap;

use files::quoted;
use safetensors::tensor::SafeTensors;

use super::numbers::floats;
use super::{Checkpoint, EMA, FORMAT, MOST_PARAMETERS, Progress, Trained};
use crate::nn::{Adam, Network};

/// [`EMA`] in version 1.
const EMA_OF_VERSION_1: &str = "average";

/// Most networks of a checkpoint.
const MOST_NETWORKS: usize = 256;

/// Longest header, bytes: metadata, names and shapes. The parser takes many times as much.
const MOST_HEADER: u64 = 4 << 20;

/// Most layers of a network, and most units of a layer.
const MOST_LAYERS: usize = 16;
const MOST_UNITS: usize = 1 << 14;

/// What a file should hold and what it holds.
pub(super) struct Wrong {
    pub(super) expected: String,
    pub(super) found: String,
}

fn wrong(expected: impl Into<String>, found: impl Into<String>) -> Wrong {
    Wrong { expected: quoted(&expected.into()), found: quoted(&found.into()) }
}

/// Parses the bytes of a checkpoint. Nothing is allocated before its size is compared with that of the file.
pub(super) fn read(data: &[u8]) -> Result<Checkpoint, Wrong> {
    let not_safe = |e: safetensors::SafeTensorError| wrong("a whole safetensors file", e.to_string());
    let header = data.first_chunk().map_or(0, |length| u64::from_le_bytes(*length));
    if header.min(data.len() as u64) > MOST_HEADER {
        return Err(wrong(format!("a header of at most {MOST_HEADER} bytes"), header.to_string()));
    }
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
    let is_rate = |rate: &f32| rate.is_finite() && *rate > 0.0;
    if let Some((role, rate)) = progress.learning_rates.iter().find(|(_, rate)| !is_rate(rate)) {
        return Err(wrong(format!("a positive learning rate of {role}"), rate.to_string()));
    }
    if progress.sizes.len() > MOST_NETWORKS {
        return Err(wrong(format!("at most {MOST_NETWORKS} networks"), progress.sizes.len().to_string()));
    }
    check_sizes(&progress)?;
    let tensors = SafeTensors::deserialize(data).map_err(not_safe)?;
    let mut networks = HashMap::new();
    for (role, (sizes, steps)) in &progress.sizes {
        let trained = read_network(role, sizes, *steps, &tensors, &progress.checksums)?;
        networks.insert(present_role(role), trained);
    }
    let p = progress;
    let mut checkpoint = Checkpoint::new(networks, (p.seed, p.samples, p.secs), p.learning_rate, p.rng);
    checkpoint.progress.learning_rates = p.learning_rates;
    Ok(checkpoint)
}

/// Refuses networks that are no networks, and more of them than a checkpoint may have.
fn check_sizes(progress: &Progress) -> Result<(), Wrong> {
    let mut parameters = 0;
    for (role, (sizes, _)) in &progress.sizes {
        let layers = 2..=MOST_LAYERS;
        if !layers.contains(&sizes.len()) || sizes.iter().any(|s| *s == 0 || *s > MOST_UNITS) {
            let expected = format!("2 to {MOST_LAYERS} sizes of 1 to {MOST_UNITS} for {role}");
            let found = format!("{} sizes, the largest {:?}", sizes.len(), sizes.iter().max());
            return Err(wrong(expected, found));
        }
        // At most 256 networks with 15 layers of 2^28 parameters: no overflow.
        parameters += Network::parameter_count(sizes);
    }
    if parameters > MOST_PARAMETERS {
        let expected = format!("at most {MOST_PARAMETERS} parameters in all networks");
        return Err(wrong(expected, parameters.to_string()));
    }
    Ok(())
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
    let mut network = Network::zeros(sizes);
    network.parameters = read("parameters")?;
    let adam = match steps {
        0 => Adam::new(count),
        steps => Adam { mean: read("mean")?, square: read("square")?, steps },
    };
    Ok(Trained { network, adam })
}
