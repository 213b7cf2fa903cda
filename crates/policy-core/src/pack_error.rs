//! Why a character pack can't be loaded.

use alloc::string::String;

use crate::action::ActionScalingError;
use crate::graph::GraphError;
use crate::mlp::{MAX_LAYERS, MlpError};
use crate::normaliser::NormaliserError;
use crate::skeleton::SkeletonError;

/// Why a character pack can't be made or read. Nothing is half loaded: there is a whole pack or this.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PackError {
    /// The bytes are no safetensors file.
    #[error("expected a safetensors file, found: {found}")]
    Container {
        /// What the reader says.
        found: String,
    },
    /// The file has no manifest.
    #[error("expected the field \"{}\" in the file's metadata, found none", crate::pack_bytes::MANIFEST_KEY)]
    NoManifest,
    /// The manifest is not the JSON it must be.
    #[error("expected a manifest as docs/pack-format.md says, found: {found}")]
    Manifest {
        /// What the parser says, with line and column.
        found: String,
    },
    /// A field of the manifest has not the one value this library works with.
    #[error("expected {field} to be {expected}, found {found}")]
    Field {
        /// Name of the field.
        field: &'static str,
        /// The value.
        expected: String,
        /// The value in the pack.
        found: String,
    },
    /// A number of the manifest is out of its range.
    #[error("expected {field} of {owner} to be {expected}, found {found}")]
    Number {
        /// Name of the field.
        field: &'static str,
        /// The skill or other thing it belongs to.
        owner: String,
        /// The range.
        expected: &'static str,
        /// The number in the pack.
        found: f32,
    },
    /// A skill that can't act in place of another one in the stride of a gait.
    #[error(
        "expected in_stride of skill \"{skill}\" to be skills with a minimum_speed_mps above 0 and no in_stride of their own, found \"{found}\""
    )]
    InStride {
        /// The skill in whose place it is to act.
        skill: String,
        /// The skill that the pack names.
        found: String,
    },
    /// A name stands for nothing.
    #[error("expected the name of a {kind} in {field}, found {found:?}")]
    UnknownName {
        /// What it should name.
        kind: &'static str,
        /// Where it stands.
        field: String,
        /// The name.
        found: String,
    },
    /// There are more or fewer of a thing than the manifest says.
    #[error("expected {expected} {what}, found {found}")]
    Count {
        /// What is counted.
        what: &'static str,
        /// How many there must be.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// There are more of a thing than a pack may have.
    #[error("expected at most {most} {what}, found {found}")]
    TooMany {
        /// What is counted.
        what: &'static str,
        /// The limit.
        most: usize,
        /// How many there are.
        found: usize,
    },
    /// A name is too long.
    #[error("expected a {kind} name of at most {most} bytes, found {found}")]
    LongName {
        /// What is named.
        kind: &'static str,
        /// The limit, bytes.
        most: usize,
        /// Its length, bytes.
        found: usize,
    },
    /// A skill can't be started from a node of a path.
    #[error("expected a way from policy {from:?} to an entry of skill {skill:?}, found none")]
    Unreachable {
        /// Name of the skill.
        skill: String,
        /// Name of the node.
        from: String,
    },
    /// The file was changed after it was written.
    #[error("expected checksum {expected}, found {found}: the file is damaged")]
    Checksum {
        /// The checksum in the file.
        expected: String,
        /// That of its bytes.
        found: String,
    },
    /// The skeleton is not valid.
    #[error("skeleton: {0}")]
    Skeleton(#[from] SkeletonError),
    /// A tensor is missing.
    #[error("expected tensor {name:?}, found none")]
    NoTensor {
        /// Its name.
        name: String,
    },
    /// A tensor belongs to nothing in the manifest.
    #[error("expected only tensors of the manifest, found {name:?} as well")]
    ExtraTensor {
        /// Its name.
        name: String,
    },
    /// A tensor has another type or shape.
    #[error("expected tensor {name:?} to be {expected}, found {found}")]
    TensorShape {
        /// Its name.
        name: String,
        /// The type and shape it must have.
        expected: String,
        /// Its type and shape.
        found: String,
    },
    /// A network can't be made of its tensors.
    #[error("network {name:?}: {source}")]
    Network {
        /// Name of the network.
        name: String,
        /// Why.
        source: MlpError,
    },
    /// A network has not the widths it must have.
    #[error("expected the widths of network {name:?} to be {expected}, found {}", shown(found))]
    Layers {
        /// Name of the network.
        name: String,
        /// The widths it must have.
        expected: String,
        /// The widths it has.
        found: alloc::vec::Vec<usize>,
    },
    /// A normaliser can't be made of its tensors.
    #[error("{which} normaliser: {source}")]
    Normaliser {
        /// `observation` or `discriminator`.
        which: &'static str,
        /// Why.
        source: NormaliserError,
    },
    /// The action scaling is not valid.
    #[error("action scaling: {0}")]
    Action(#[from] ActionScalingError),
    /// The graph is not valid.
    #[error("graph: {0}")]
    Graph(#[from] GraphError),
}

/// Widths of a network for a message; of many only the first.
fn shown(widths: &[usize]) -> String {
    match widths.get(..MAX_LAYERS + 1) {
        Some(first) if first.len() < widths.len() => {
            alloc::format!("{} widths, the first {first:?}", widths.len())
        }
        _ => alloc::format!("{widths:?}"),
    }
}

#[cfg(test)]
mod tests {
    use alloc::string::ToString;

    use super::*;

    #[test]
    fn many_widths_are_not_all_told() {
        let error = |found| PackError::Layers { name: "a".into(), expected: "2 to 5 numbers".into(), found };
        let long = error(alloc::vec![7; 100_000]).to_string();
        assert!(long.len() < 150 && long.contains("100000 widths, the first [7, 7,"), "{long}");
        assert!(error(alloc::vec![3, 4]).to_string().ends_with("to be 2 to 5 numbers, found [3, 4]"));
    }
}
