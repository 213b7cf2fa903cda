//! A pack as bytes: safetensors, with the manifest as JSON in its metadata. Specified in
//! `docs/pack-format.md`.

use alloc::format;
use alloc::string::{String, ToString};
use alloc::vec::Vec;

use safetensors::tensor::{Dtype, SafeTensors, TensorView};

use crate::features::FRAME_LEN;
use crate::manifest::Manifest;
use crate::mlp::{Layer, MAX_LAYERS, Mlp};
use crate::normaliser::Normaliser;
use crate::observation::OBSERVATION_LEN;
use crate::pack::{CharacterPack, PackTensors};
use crate::pack_error::PackError;

/// Key of the manifest in the file's metadata.
pub(crate) const MANIFEST_KEY: &str = "policy_space";

const OBSERVATION: &str = "normaliser.observation";
const DISCRIMINATOR: &str = "normaliser.discriminator";

impl CharacterPack {
    /// Reads a pack from the bytes of a file, such as those of `include_bytes!`.
    ///
    /// # Errors
    /// When the bytes are no pack, or anything in it is not as it must be; see [`PackError`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, PackError> {
        let container = |e: safetensors::SafeTensorError| PackError::Container { found: e.to_string() };
        let (_, metadata) = SafeTensors::read_metadata(bytes).map_err(container)?;
        let file = SafeTensors::deserialize(bytes).map_err(container)?;
        let json = metadata.metadata().as_ref().and_then(|m| m.get(MANIFEST_KEY));
        let manifest: Manifest = serde_json::from_str(json.ok_or(PackError::NoManifest)?)
            .map_err(|e| PackError::Manifest { found: e.to_string() })?;
        let mut reader = Reader { file, used: Vec::new() };
        let policies = manifest.policies.iter().map(|p| reader.network("policy", &p.name, &p.layers));
        let policies = policies.collect::<Result<_, _>>()?;
        let discriminators = manifest.discriminators.iter();
        let discriminators = discriminators.map(|d| reader.network("discriminator", &d.name, &d.layers));
        let tensors = PackTensors {
            policies,
            discriminators: discriminators.collect::<Result<_, _>>()?,
            observation_normaliser: reader.normaliser("observation", OBSERVATION, OBSERVATION_LEN)?,
            discriminator_normaliser: reader.normaliser("discriminator", DISCRIMINATOR, FRAME_LEN)?,
        };
        reader.refuse_unused()?;
        Self::from_parts(manifest, tensors)
    }

    /// The pack as the bytes of a file. The same pack always gives the same bytes.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let (manifest, tensors) = (self.manifest(), self.tensors());
        let mut numbers: Vec<(String, Vec<usize>, Vec<u8>)> = Vec::new();
        let mut push = |name: String, shape: Vec<usize>, values: &mut dyn Iterator<Item = f32>| {
            numbers.push((name, shape, values.flat_map(f32::to_le_bytes).collect()));
        };
        let policies = manifest.policies.iter().map(|p| ("policy", &p.name)).zip(&tensors.policies);
        let discriminators = manifest.discriminators.iter().map(|d| ("discriminator", &d.name));
        for ((kind, name), mlp) in policies.chain(discriminators.zip(&tensors.discriminators)) {
            for (i, layer) in mlp.layers().iter().enumerate() {
                let shape = alloc::vec![layer.inputs(), layer.outputs()];
                push(tensor_name(kind, name, i, "weight"), shape, &mut layer.weight());
                push(tensor_name(kind, name, i, "bias"), alloc::vec![layer.outputs()], &mut layer.bias());
            }
        }
        let normalisers = [
            (OBSERVATION, &tensors.observation_normaliser),
            (DISCRIMINATOR, &tensors.discriminator_normaliser),
        ];
        for (prefix, n) in normalisers {
            push(format!("{prefix}.mean"), alloc::vec![n.len()], &mut n.mean().iter().copied());
            push(format!("{prefix}.deviation"), alloc::vec![n.len()], &mut n.deviation().iter().copied());
        }
        let views = numbers.iter().map(|(name, shape, data)| {
            let view = TensorView::new(Dtype::F32, shape.clone(), data);
            (name.as_str(), view.expect("four bytes for each number of the shape"))
        });
        let json = serde_json::to_string(manifest).expect("a manifest of strings and finite numbers is JSON");
        let metadata = core::iter::once((MANIFEST_KEY.to_string(), json)).collect();
        safetensors::serialize(views, Some(metadata)).expect("views of the right length serialise")
    }
}

fn tensor_name(kind: &str, name: &str, layer: usize, part: &str) -> String {
    format!("{kind}.{name}.layer{}.{part}", layer + 1)
}

struct Reader<'a> {
    file: SafeTensors<'a>,
    used: Vec<String>,
}

impl Reader<'_> {
    fn numbers(&mut self, name: String, shape: &[usize]) -> Result<Vec<f32>, PackError> {
        let Ok(view) = self.file.tensor(&name) else {
            return Err(PackError::NoTensor { name });
        };
        if view.dtype() != Dtype::F32 || view.shape() != shape {
            let found = format!("{:?} {:?}", view.dtype(), view.shape());
            return Err(PackError::TensorShape { name, expected: shape.into(), found });
        }
        self.used.push(name);
        Ok(view.data().as_chunks::<4>().0.iter().map(|b| f32::from_le_bytes(*b)).collect())
    }

    fn network(&mut self, kind: &str, name: &str, layers: &[usize]) -> Result<Mlp, PackError> {
        if !(2..=MAX_LAYERS + 1).contains(&layers.len()) {
            let expected = format!("of 1 to {MAX_LAYERS} layers");
            return Err(PackError::Layers { name: name.into(), expected, found: layers.into() });
        }
        let network = |source| PackError::Network { name: name.into(), source };
        let mut made = Vec::with_capacity(layers.len() - 1);
        for (i, ends) in layers.windows(2).enumerate() {
            let weight = self.numbers(tensor_name(kind, name, i, "weight"), ends)?;
            let bias = self.numbers(tensor_name(kind, name, i, "bias"), &ends[1..])?;
            made.push(Layer::from_input_major(ends[0], ends[1], &weight, &bias).map_err(network)?);
        }
        Mlp::from_layers(made).map_err(network)
    }

    fn normaliser(&mut self, which: &'static str, prefix: &str, len: usize) -> Result<Normaliser, PackError> {
        let mean = self.numbers(format!("{prefix}.mean"), &[len])?;
        let deviation = self.numbers(format!("{prefix}.deviation"), &[len])?;
        Normaliser::from_mean_and_deviation(&mean, &deviation)
            .map_err(|source| PackError::Normaliser { which, source })
    }

    fn refuse_unused(&self) -> Result<(), PackError> {
        let extra = self.file.names().into_iter().find(|name| !self.used.iter().any(|u| u == name));
        extra.map_or(Ok(()), |name| Err(PackError::ExtraTensor { name: name.into() }))
    }
}
