//! Reads accessors after checking that their bytes are there: the gltf crate trusts what a document says.

use std::cell::Cell;

use gltf::accessor::{DataType, Dimensions};

use super::{MAX_INDICES, MAX_VERTICES, MeshError};

/// The document and its binary chunk, every accessor known to lie inside.
pub(super) struct Checked<'a> {
    pub(super) document: &'a gltf::Document,
    blob: &'a [u8],
    vertices: Cell<usize>,
    indices: Cell<usize>,
}

impl<'a> Checked<'a> {
    pub(super) fn new(document: &'a gltf::Document, blob: &'a [u8]) -> Result<Self, MeshError> {
        for buffer in document.buffers() {
            if !matches!(buffer.source(), gltf::buffer::Source::Bin) {
                return Err(MeshError::NoBinary);
            }
            check("buffer", buffer.index(), buffer.length() as u64, blob.len() as u64)?;
        }
        for view in document.views() {
            let end = (view.offset() as u64).saturating_add(view.length() as u64);
            check("buffer view", view.index(), end, view.buffer().length() as u64)?;
        }
        for accessor in document.accessors() {
            check_accessor(&accessor)?;
        }
        Ok(Self { document, blob, vertices: Cell::new(0), indices: Cell::new(0) })
    }

    /// Counts vertices that are about to be read. Many primitives may name one accessor, so that a small file can
    /// ask for more than any memory holds.
    pub(super) fn take_vertices(&self, count: usize) -> Result<(), MeshError> {
        take(&self.vertices, count, "vertices", MAX_VERTICES)
    }

    /// The same for indices.
    pub(super) fn take_indices(&self, count: usize) -> Result<(), MeshError> {
        take(&self.indices, count, "indices", MAX_INDICES)
    }

    /// Gives the readers of the gltf crate the data of a buffer.
    pub(super) fn data(&self) -> impl Clone + Fn(gltf::Buffer<'a>) -> Option<&'a [u8]> {
        let blob = self.blob;
        move |_| Some(blob)
    }
}

fn take(taken: &Cell<usize>, count: usize, what: &'static str, most: usize) -> Result<(), MeshError> {
    let found = taken.get().saturating_add(count);
    taken.set(found);
    if found > most { Err(MeshError::TooMany { what, most, found }) } else { Ok(()) }
}

fn check_accessor(accessor: &gltf::Accessor<'_>) -> Result<(), MeshError> {
    let index = accessor.index();
    if accessor.sparse().is_some() {
        return Err(MeshError::Unsupported { what: format!("sparse accessor {index}") });
    }
    let view = accessor
        .view()
        .ok_or_else(|| MeshError::Unsupported { what: format!("accessor {index} without a buffer view") })?;
    if accessor.count() == 0 {
        return Err(MeshError::Unsupported { what: format!("empty accessor {index}") });
    }
    let size = accessor.size() as u64;
    let stride = view.stride().map_or(size, |s| s as u64).max(size);
    let end = (accessor.count() as u64 - 1)
        .saturating_mul(stride)
        .saturating_add(size)
        .saturating_add(accessor.offset() as u64);
    check("accessor", index, end, view.length() as u64)
}

fn check(what: &'static str, index: usize, expected: u64, found: u64) -> Result<(), MeshError> {
    if expected > found { Err(MeshError::Truncated { what, index, expected, found }) } else { Ok(()) }
}

/// True when the accessor holds vectors of `dimensions` in one of `types`.
pub(super) fn is_kind(accessor: &gltf::Accessor<'_>, dimensions: Dimensions, types: &[DataType]) -> bool {
    accessor.dimensions() == dimensions && types.contains(&accessor.data_type())
}
