//! A pack as bytes: safetensors, with the manifest as JSON in its metadata. Specified in
//! `docs/pack-format.md`.

use alloc::format;
use alloc::string::{String, ToString};
use alloc::vec::Vec;

use half::f16;
use safetensors::tensor::{Dtype, SafeTensors, TensorView};
use serde::Deserialize;

use crate::excerpt::excerpt;
use crate::format::{MAX_HEADER_BYTES, MAX_PACK_BYTES, Manifest, PACK_VERSION, Storage};
use crate::format_one::{self, ManifestOne};
use crate::mlp::{Layer, MAX_LAYERS, Mlp};
use crate::normaliser::Normaliser;
use crate::pack::{CharacterPack, PackTensors};
use crate::pack_error::PackError;
use crate::pack_parts::check_manifest;

/// Key of the manifest in the file's metadata.
pub(crate) const MANIFEST_KEY: &str = "policy_space";

const OBSERVATION: &str = "normaliser.observation";
const DISCRIMINATOR: &str = "normaliser.discriminator";
const MESH: &str = "mesh.glb";

/// What stands before the digits of the checksum, in JSON inside JSON.
const CHECKSUM_MARK: &[u8] = br#"\"checksum\":\""#;

/// Digits of a checksum that is not known yet.
const NO_CHECKSUM: &str = "00000000";

impl CharacterPack {
    /// Reads a pack of version 1 or 2 from the bytes of a file, such as those of `include_bytes!`.
    ///
    /// # Errors
    /// When the bytes are no pack, are damaged, or anything in them is not as it must be; see [`PackError`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, PackError> {
        let container = |e: safetensors::SafeTensorError| PackError::Container { found: excerpt(e) };
        check_sizes(bytes)?;
        let (header_len, metadata) = SafeTensors::read_metadata(bytes).map_err(container)?;
        let json = metadata.metadata().as_ref().and_then(|m| m.get(MANIFEST_KEY));
        let manifest = manifest(json.ok_or(PackError::NoManifest)?)?;
        if let Some(expected) = &manifest.checksum {
            let found = checksum(bytes, header_len);
            if found.as_ref() != Some(expected) {
                let (expected, found) = (excerpt(expected), found.unwrap_or_else(|| "none".into()));
                return Err(PackError::Checksum { expected, found });
            }
        }
        check_manifest(&manifest)?;
        let file = SafeTensors::deserialize(bytes).map_err(container)?;
        let mut reader = Reader { file, used: Vec::new() };
        let policies =
            manifest.policies.iter().map(|p| reader.network("policy", &p.name, &p.layers, Storage::F32));
        let policies = policies.collect::<Result<_, _>>()?;
        let discriminators = manifest
            .discriminators
            .iter()
            .map(|d| reader.network("discriminator", &d.name, &d.layers, d.storage));
        let tensors = PackTensors {
            policies,
            discriminators: discriminators.collect::<Result<_, _>>()?,
            observation_normaliser: reader.normaliser("observation", OBSERVATION)?,
            discriminator_normaliser: reader.normaliser("discriminator", DISCRIMINATOR)?,
            mesh: reader.mesh(),
        };
        reader.refuse_unused()?;
        let checksum = manifest.checksum.clone();
        Ok(Self::from_parts(manifest, tensors)?.with_checksum(checksum))
    }

    /// The pack as the bytes of a file of the present version, with a checksum. The same pack always gives the same bytes.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let manifest = Manifest { checksum: Some(NO_CHECKSUM.into()), ..self.manifest().clone() };
        let tensors = self.tensors();
        let mut list = TensorList::default();
        for (entry, mlp) in manifest.policies.iter().zip(&tensors.policies) {
            list.network("policy", &entry.name, mlp, Storage::F32);
        }
        for (entry, mlp) in manifest.discriminators.iter().zip(&tensors.discriminators) {
            list.network("discriminator", &entry.name, mlp, entry.storage);
        }
        let normalisers = [
            (OBSERVATION, &tensors.observation_normaliser),
            (DISCRIMINATOR, &tensors.discriminator_normaliser),
        ];
        for (prefix, n) in normalisers {
            let shape = alloc::vec![n.len()];
            list.floats(format!("{prefix}.mean"), shape.clone(), &mut n.mean().iter().copied(), Storage::F32);
            list.floats(
                format!("{prefix}.deviation"),
                shape,
                &mut n.deviation().iter().copied(),
                Storage::F32,
            );
        }
        if let Some(mesh) = &tensors.mesh {
            list.0.push((MESH.into(), Dtype::U8, alloc::vec![mesh.len()], mesh.clone()));
        }
        let json =
            serde_json::to_string(&manifest).expect("a manifest of strings and finite numbers is JSON");
        let mut bytes = list.serialised(json);
        write_checksum(&mut bytes);
        bytes
    }
}

/// Bounds the file and its header before anything is allocated for them.
fn check_sizes(bytes: &[u8]) -> Result<(), PackError> {
    let header = bytes.first_chunk().map_or(0, |length| u64::from_le_bytes(*length));
    let sizes = [
        ("bytes", bytes.len() as u64, MAX_PACK_BYTES),
        // A length that no file has room for is the container's fault.
        ("bytes in the header", header.min(bytes.len() as u64), MAX_HEADER_BYTES),
    ];
    match sizes.into_iter().find(|&(_, found, most)| found > most as u64) {
        Some((what, found, most)) => Err(PackError::TooMany { what, most, found: found as usize }),
        None => Ok(()),
    }
}

/// Parses the manifest, of any version that this library reads.
fn manifest(json: &str) -> Result<Manifest, PackError> {
    /// The one field that all versions share.
    #[derive(Deserialize)]
    struct Versioned {
        version: u32,
    }
    let wrong = |e: serde_json::Error| PackError::Manifest { found: excerpt(e) };
    match serde_json::from_str(json).map_err(wrong)? {
        Versioned { version: format_one::VERSION } => {
            serde_json::from_str::<ManifestOne>(json).map_err(wrong)?.upgraded()
        }
        Versioned { version: PACK_VERSION } => serde_json::from_str(json).map_err(wrong),
        Versioned { version } => Err(PackError::Field {
            field: "version",
            expected: format!("{} or {PACK_VERSION}", format_one::VERSION),
            found: version.to_string(),
        }),
    }
}

/// Place of the checksum's digits in a file.
fn checksum_digits(bytes: &[u8], header_len: usize) -> Option<core::ops::Range<usize>> {
    let header = bytes.get(..8 + header_len)?;
    let mark = header.windows(CHECKSUM_MARK.len()).position(|w| w == CHECKSUM_MARK)? + CHECKSUM_MARK.len();
    (mark + NO_CHECKSUM.len() <= header.len()).then_some(mark..mark + NO_CHECKSUM.len())
}

/// CRC-32 of a file whose own digits count as zeros; `None` when it has none where they belong.
fn checksum(bytes: &[u8], header_len: usize) -> Option<String> {
    let digits = checksum_digits(bytes, header_len)?;
    let mut crc = crc32fast::Hasher::new();
    // The digits were found inside the file.
    crc.update(&bytes[..digits.start]);
    crc.update(NO_CHECKSUM.as_bytes());
    crc.update(&bytes[digits.end..]);
    Some(format!("{:08x}", crc.finalize()))
}

fn write_checksum(bytes: &mut [u8]) {
    let (header_len, _) = SafeTensors::read_metadata(bytes).expect("the file was just serialised");
    let digits = checksum_digits(bytes, header_len).expect("the manifest was written with a checksum");
    let sum = checksum(bytes, header_len).expect("the digits were just found");
    bytes[digits].copy_from_slice(sum.as_bytes());
}

fn tensor_name(kind: &str, name: &str, layer: usize, part: &str) -> String {
    format!("{kind}.{name}.layer{}.{part}", layer + 1)
}

/// Tensors to be written: name, type, shape, bytes.
#[derive(Default)]
struct TensorList(Vec<(String, Dtype, Vec<usize>, Vec<u8>)>);

impl TensorList {
    fn floats(
        &mut self,
        name: String,
        shape: Vec<usize>,
        values: &mut dyn Iterator<Item = f32>,
        storage: Storage,
    ) {
        let (dtype, bytes) = match storage {
            Storage::F32 => (Dtype::F32, values.flat_map(f32::to_le_bytes).collect()),
            Storage::F16 => (Dtype::F16, values.flat_map(|v| f16::from_f32(v).to_le_bytes()).collect()),
        };
        self.0.push((name, dtype, shape, bytes));
    }

    fn network(&mut self, kind: &str, name: &str, mlp: &Mlp, storage: Storage) {
        for (i, layer) in mlp.layers().iter().enumerate() {
            let (inputs, outputs) = (layer.inputs(), layer.outputs());
            let weight = tensor_name(kind, name, i, "weight");
            self.floats(weight, alloc::vec![inputs, outputs], &mut layer.weight(), storage);
            let bias = tensor_name(kind, name, i, "bias");
            self.floats(bias, alloc::vec![outputs], &mut layer.bias(), storage);
        }
    }

    fn serialised(&self, manifest: String) -> Vec<u8> {
        let views = self.0.iter().map(|(name, dtype, shape, data)| {
            let view = TensorView::new(*dtype, shape.clone(), data);
            (name.as_str(), view.expect("as many bytes as the shape says"))
        });
        let metadata = core::iter::once((MANIFEST_KEY.to_string(), manifest)).collect();
        safetensors::serialize(views, Some(metadata)).expect("views of the right length serialise")
    }
}

struct Reader<'a> {
    file: SafeTensors<'a>,
    used: Vec<String>,
}

impl Reader<'_> {
    /// Numbers of a tensor; its shape must be `shape`, or any vector where that is `None`.
    fn numbers(
        &mut self,
        name: String,
        shape: Option<&[usize]>,
        storage: Storage,
    ) -> Result<Vec<f32>, PackError> {
        let Ok(view) = self.file.tensor(&name) else {
            return Err(PackError::NoTensor { name });
        };
        let dtype = match storage {
            Storage::F32 => Dtype::F32,
            Storage::F16 => Dtype::F16,
        };
        let fits = shape.map_or(view.shape().len() == 1, |shape| view.shape() == shape);
        if view.dtype() != dtype || !fits {
            let shape = shape.map_or("vector".into(), |shape| format!("{shape:?}"));
            let (expected, found) =
                (format!("{dtype:?} {shape}"), format!("{:?} {:?}", view.dtype(), view.shape()));
            return Err(PackError::TensorShape { name, expected, found });
        }
        self.used.push(name);
        Ok(match storage {
            Storage::F32 => view.data().as_chunks::<4>().0.iter().map(|b| f32::from_le_bytes(*b)).collect(),
            Storage::F16 => {
                view.data().as_chunks::<2>().0.iter().map(|b| f16::from_le_bytes(*b).to_f32()).collect()
            }
        })
    }

    fn network(
        &mut self,
        kind: &str,
        name: &str,
        layers: &[usize],
        storage: Storage,
    ) -> Result<Mlp, PackError> {
        if !(2..=MAX_LAYERS + 1).contains(&layers.len()) {
            let expected = format!("2 to {} numbers", MAX_LAYERS + 1);
            return Err(PackError::Layers { name: name.into(), expected, found: layers.into() });
        }
        let network = |source| PackError::Network { name: name.into(), source };
        let mut made = Vec::with_capacity(layers.len() - 1);
        for (i, ends) in layers.windows(2).enumerate() {
            let weight = self.numbers(tensor_name(kind, name, i, "weight"), Some(ends), storage)?;
            // `windows(2)` gives pairs.
            let bias = self.numbers(tensor_name(kind, name, i, "bias"), Some(&ends[1..]), storage)?;
            made.push(Layer::from_input_major(ends[0], ends[1], &weight, &bias).map_err(network)?);
        }
        Mlp::from_layers(made).map_err(network)
    }

    fn normaliser(&mut self, which: &'static str, prefix: &str) -> Result<Normaliser, PackError> {
        let mean = self.numbers(format!("{prefix}.mean"), None, Storage::F32)?;
        let deviation = self.numbers(format!("{prefix}.deviation"), None, Storage::F32)?;
        Normaliser::from_mean_and_deviation(&mean, &deviation)
            .map_err(|source| PackError::Normaliser { which, source })
    }

    /// The mesh, if there is one of bytes.
    fn mesh(&mut self) -> Option<Vec<u8>> {
        let view = self.file.tensor(MESH).ok().filter(|view| view.dtype() == Dtype::U8)?;
        self.used.push(MESH.into());
        Some(view.data().to_vec())
    }

    fn refuse_unused(&self) -> Result<(), PackError> {
        let extra = self.file.names().into_iter().find(|name| !self.used.iter().any(|u| u == name));
        extra.map_or(Ok(()), |name| Err(PackError::ExtraTensor { name: excerpt(name) }))
    }
}
