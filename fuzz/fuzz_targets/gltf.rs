//! A mesh made of anything: a whole `.glb`, or any document around sound bytes. It is refused, or it can be drawn.
#![no_main]

use std::sync::{Arc, LazyLock};

use libfuzzer_sys::fuzz_target;
use policy_core::Skeleton;
use policy_core::glam::{Quat, Vec3};
use policy_core::training::{Roles, SkeletonBody, SkeletonJoint};
use policy_core::BodyId;
use viewer::mesh::{Rig, SkinnedMesh};

/// Bytes of the binary chunk around which a document is put.
const BLOB: usize = 1024;

/// A trunk and a head, whose names a small document can carry.
static RIG: LazyLock<Rig> = LazyLock::new(|| {
    let body = |name: &str, parent| SkeletonBody { name: name.into(), parent };
    let bodies = vec![body("a", None), body("b", Some(BodyId::new(0)))];
    let (name, body) = ("c".into(), BodyId::new(1));
    let neck = SkeletonJoint { name, body, axis: Vec3::Y, range: [-1.0, 1.0] };
    let skeleton = Skeleton::from_parts(bodies, vec![neck], Roles::default()).expect("a sound skeleton");
    Rig::new(Arc::new(skeleton), vec![Vec3::ZERO, Vec3::Z])
});

fuzz_target!(|bytes: &[u8]| {
    if bytes.starts_with(b"glTF") { read(bytes) } else { read(&glb(bytes)) }
});

fn read(bytes: &[u8]) {
    let Ok(mesh) = SkinnedMesh::from_bytes(bytes, &RIG) else { return };
    let mut palette = Vec::new();
    mesh.palette_into(&[Vec3::ZERO; 2], &[Quat::IDENTITY; 2], &mut palette);
    assert_eq!(palette.len(), mesh.joints.len());
    for level in &mesh.levels {
        for vertex in &level.vertices {
            assert!(vertex.position.iter().all(|number| number.is_finite()));
            assert!(vertex.joints.iter().all(|joint| usize::from(*joint) < mesh.joints.len()));
        }
        assert!(level.indices.iter().all(|index| (*index as usize) < level.vertices.len()));
        for part in &level.parts {
            assert!(part.material < mesh.materials.len());
            assert!(part.indices.end as usize <= level.indices.len());
        }
    }
}

/// A binary glTF of this document, with positions, normals, joints and weights of a triangle behind it.
fn glb(document: &[u8]) -> Vec<u8> {
    let length = document.len().next_multiple_of(4);
    let mut bytes = b"glTF".to_vec();
    for word in [2, 28 + length + BLOB, length] {
        bytes.extend((word as u32).to_le_bytes());
    }
    bytes.extend(b"JSON");
    bytes.extend(document);
    bytes.resize(20 + length, b' ');
    bytes.extend((BLOB as u32).to_le_bytes());
    bytes.extend(b"BIN\0");
    // Ones as floats are finite in every place; as bytes they are joints and weights.
    bytes.extend(1.0f32.to_le_bytes().repeat(BLOB / 8));
    bytes.extend([0, 0, 0, 1].repeat(BLOB / 8));
    bytes
}
