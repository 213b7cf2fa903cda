//! From bytes to a document that the gltf crate can validate: it trusts some indices and lengths before it has
//! checked them.

use gltf::json::{Index, Root, accessor::Accessor};

use super::{MAX_MESH_BYTES, MeshError};

/// Most nodes, meshes, accessors or buffer views of a document.
const MOST_PARTS: usize = 4096;
/// Longest JSON of a document, bytes. The parser takes a hundred times as much for empty parts.
const MOST_JSON: usize = 2 << 20;
/// Bytes of the header of a `.glb`, and where its total length and that of the JSON are.
const HEADER_BYTES: u32 = 12;
const LENGTH_AT: usize = 8;
const JSON_LENGTH_AT: usize = 12;

pub(super) fn parse(bytes: &[u8]) -> Result<gltf::Gltf, MeshError> {
    if bytes.len() as u64 > MAX_MESH_BYTES {
        return Err(MeshError::TooMany { what: "bytes", most: MAX_MESH_BYTES as usize, found: bytes.len() });
    }
    check_header(bytes)?;
    let parsed = gltf::Gltf::from_slice_without_validation(bytes).map_err(MeshError::Parse)?;
    let root = parsed.document.into_json();
    check_counts(&root)?;
    check_attributes(&root)?;
    let document = gltf::Document::from_json(root).map_err(MeshError::Parse)?;
    Ok(gltf::Gltf { document, blob: parsed.blob })
}

/// The gltf crate subtracts the size of the header from the length that the header says. What is no `.glb` is parsed as
/// JSON alone.
fn check_header(bytes: &[u8]) -> Result<(), MeshError> {
    let word = |at| bytes.get(at..).and_then(|rest| rest.first_chunk()).map(|b| u32::from_le_bytes(*b));
    if !bytes.starts_with(b"glTF") {
        return check_json(bytes.len());
    }
    match word(LENGTH_AT) {
        Some(found) if found < HEADER_BYTES => {
            let (expected, found) = (HEADER_BYTES.into(), found.into());
            Err(MeshError::Truncated { what: "file", index: 0, expected, found })
        }
        // A length that the file has no room for is told by the parser.
        _ => check_json(word(JSON_LENGTH_AT).map_or(0, |length| length as usize).min(bytes.len())),
    }
}

fn check_json(found: usize) -> Result<(), MeshError> {
    if found > MOST_JSON {
        return Err(MeshError::TooMany { what: "bytes of JSON", most: MOST_JSON, found });
    }
    Ok(())
}

fn check_counts(root: &Root) -> Result<(), MeshError> {
    let counts = [
        ("nodes", root.nodes.len()),
        ("meshes", root.meshes.len()),
        ("accessors", root.accessors.len()),
        ("buffer views", root.buffer_views.len()),
    ];
    match counts.into_iter().find(|(_, count)| *count > MOST_PARTS) {
        Some((what, found)) => Err(MeshError::TooMany { what, most: MOST_PARTS, found }),
        None => Ok(()),
    }
}

/// The gltf crate looks at the accessor of positions before it knows that there is one.
fn check_attributes(root: &Root) -> Result<(), MeshError> {
    let most = root.accessors.len();
    for (number, mesh) in root.meshes.iter().enumerate() {
        for (primitive, of_mesh) in mesh.primitives.iter().enumerate() {
            let beyond = |index: &&Index<Accessor>| index.value() >= most;
            if let Some(index) = of_mesh.attributes.values().find(beyond) {
                return Err(MeshError::Inconsistent {
                    mesh: mesh.name.clone().unwrap_or_else(|| number.to_string()),
                    primitive,
                    expected: format!("accessors below {most}"),
                    found: index.value().to_string(),
                });
            }
        }
    }
    Ok(())
}
