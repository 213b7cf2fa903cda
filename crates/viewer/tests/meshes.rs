//! Humanoids from glTF: ours is what the generator makes, others are refused with a clear message.

use glam::{Quat, Vec3};
use policy_core::{BodyId, Skeleton};
use viewer::assets::{HUMANOID_GLB, HUMANOID_MJCF};
use viewer::mannequin;
use viewer::mesh::{MeshError, Rig, SkinnedMesh};

/// What the mannequin is bound to.
fn rig() -> Rig {
    Rig::new(Skeleton::humanoid().into(), mannequin::rest_positions().to_vec())
}

fn body(name: &str) -> BodyId {
    Skeleton::humanoid().body_named(name).unwrap()
}

/// The document of our mannequin and its binary chunk.
fn parts() -> (serde_json::Value, Vec<u8>) {
    let length = u32::from_le_bytes(HUMANOID_GLB[12..16].try_into().unwrap()) as usize;
    let document = serde_json::from_slice(&HUMANOID_GLB[20..20 + length]).unwrap();
    (document, HUMANOID_GLB[28 + length..].to_vec())
}

fn glb(document: &serde_json::Value, binary: &[u8]) -> Vec<u8> {
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut bytes = b"glTF".to_vec();
    let total = 28 + text.len() + binary.len();
    for word in [2, total as u32, text.len() as u32] {
        bytes.extend_from_slice(&word.to_le_bytes());
    }
    bytes.extend_from_slice(b"JSON");
    bytes.extend_from_slice(&text);
    bytes.extend_from_slice(&(binary.len() as u32).to_le_bytes());
    bytes.extend_from_slice(b"BIN\0");
    bytes.extend_from_slice(binary);
    bytes
}

/// What is said of our mannequin after `change`.
fn refused(change: impl FnOnce(&mut serde_json::Value)) -> String {
    let (mut document, binary) = parts();
    change(&mut document);
    SkinnedMesh::from_bytes(&glb(&document, &binary), &rig()).expect_err("should be refused").to_string()
}

#[test]
fn the_asset_is_what_the_generator_makes() {
    assert!(
        mannequin::generate() == HUMANOID_GLB,
        "run: cargo run -p viewer --bin mannequin -- assets/humanoid.glb"
    );
}

#[test]
fn its_rest_pose_is_that_of_the_mjcf() {
    for (index, body) in Skeleton::humanoid().bodies().iter().enumerate() {
        let start = HUMANOID_MJCF.find(&format!("<body name=\"{}\"", body.name)).unwrap();
        let element = HUMANOID_MJCF[start..].split('>').next().unwrap();
        let text = element.split("pos=\"").nth(1).unwrap().split('"').next().unwrap();
        let numbers: Vec<f32> = text.split_whitespace().map(|n| n.parse().unwrap()).collect();
        if body.parent.is_some() {
            let apart = (Vec3::from_slice(&numbers) - mannequin::REST_OFFSETS[index]).length();
            assert!(apart < 1e-6, "{}: {apart}", body.name);
        }
    }
}

#[test]
fn joints_at_rest_leave_the_mesh_where_it_is() {
    let mesh = SkinnedMesh::from_bytes(HUMANOID_GLB, &rig()).unwrap();
    assert_eq!((mesh.joints.len(), mesh.levels.len()), (15, 4));
    for pair in mesh.levels.windows(2) {
        assert!(pair[1].vertices.len() * 3 < pair[0].vertices.len() * 2);
    }
    let mut palette = Vec::new();
    mesh.palette_into(&mannequin::rest_positions(), &[Quat::IDENTITY; 15], &mut palette);
    for vertex in &mesh.levels[0].vertices {
        let total: u32 = vertex.follow.iter().map(|f| u32::from(*f)).sum();
        assert_eq!(total, 255);
        let [x, y, z] = vertex.position;
        let moved =
            palette[vertex.joints[0] as usize].map(|row| row[0] * x + row[1] * y + row[2] * z + row[3]);
        // glTF (x, y, z) is (z, x, y) of the world.
        let apart = Vec3::from(moved).distance(Vec3::new(z, x, y));
        assert!(apart < 1e-5, "{vertex:?} moved by {apart}");
    }
    let lowest = mesh.levels[0].vertices.iter().map(|v| v.position[1]).fold(f32::INFINITY, f32::min);
    let sole = mannequin::rest_positions()[body("left_foot").index()].z - 0.05;
    assert!((lowest - sole).abs() < 2e-3, "soles at {lowest}, collision boxes at {sole}");
}

#[test]
fn a_t_pose_is_turned_to_the_rest_pose() {
    let (mut document, mut binary) = parts();
    // Arms of a T-pose: the left lower arm lies beside its shoulder, not below.
    let node = document["nodes"].as_array_mut().unwrap();
    let left = body("left_lower_arm").index();
    node[left]["translation"] = serde_json::json!([0.274_788, 0.0, 0.0]);
    // Without inverse bind matrices the mesh stands in joint space: the joint's own place is its origin.
    document["skins"][0].as_object_mut().unwrap().remove("inverseBindMatrices");
    let bytes = glb(&document, &std::mem::take(&mut binary));
    let mesh = SkinnedMesh::from_bytes(&bytes, &rig()).unwrap();
    let upper = mesh.joints.iter().find(|j| j.body == body("left_upper_arm")).unwrap();
    // What points sideways in the mesh (x of glTF) points down in the frame of the upper arm.
    let turned = upper.body_from_mesh.transform_vector3(Vec3::X);
    assert!(turned.distance(Vec3::NEG_Z) < 1e-4, "{turned}");
}

#[test]
fn every_truncation_is_an_error_and_no_panic() {
    let lengths = (0..64).chain((64..HUMANOID_GLB.len()).step_by(48_611));
    for length in lengths {
        assert!(SkinnedMesh::from_bytes(&HUMANOID_GLB[..length], &rig()).is_err(), "{length} bytes");
    }
    let error = SkinnedMesh::from_bytes(b"# not a mesh", &rig()).unwrap_err();
    assert!(matches!(error, MeshError::Parse(_)), "{error}");
}

#[test]
fn what_is_missing_is_named() {
    let said = refused(|d| {
        d["nodes"][15].as_object_mut().unwrap().remove("skin");
    });
    assert!(said.contains("expected a skin"), "{said}");
    let said = refused(|d| d["nodes"][4]["name"] = "forearm.R".into());
    assert!(said.contains("right_lower_arm"), "{said}");
    let said = refused(|d| {
        d["meshes"][0]["primitives"][1]["attributes"].as_object_mut().unwrap().remove("NORMAL");
    });
    assert!(said.contains("mannequin") && said.contains("primitive 1") && said.contains("NORMAL"), "{said}");
    let said = refused(|d| {
        d["meshes"][0]["primitives"][0]["attributes"].as_object_mut().unwrap().remove("WEIGHTS_0");
    });
    assert!(said.contains("WEIGHTS_0"), "{said}");
}

#[test]
fn absurd_counts_and_places_are_refused() {
    for count in [1_u64 << 20, 1 << 31, 1 << 62] {
        for accessor in 0..7 {
            let said = refused(|d| d["accessors"][accessor]["count"] = count.into());
            assert!(said.contains("accessor") || said.contains("expected"), "{said}");
        }
    }
    let said = refused(|d| d["bufferViews"][2]["byteOffset"] = (1_u64 << 40).into());
    assert!(said.contains("buffer view 2"), "{said}");
    let said = refused(|d| d["buffers"][0]["byteLength"] = (1_u64 << 40).into());
    assert!(said.contains("buffer 0"), "{said}");
    let said = refused(|d| d["accessors"][0]["type"] = "VEC2".into());
    assert!(said.contains("POSITION"), "{said}");
    let said = refused(|d| d["nodes"][2]["children"] = serde_json::json!([0]));
    assert!(!said.is_empty());
}

#[test]
fn numbers_that_make_no_sense_are_refused() {
    let (document, mut binary) = parts();
    binary[..4].copy_from_slice(&f32::NAN.to_le_bytes());
    let said = SkinnedMesh::from_bytes(&glb(&document, &binary), &rig()).unwrap_err().to_string();
    assert!(said.contains("finite") && said.contains("NaN"), "{said}");
    let (document, mut binary) = parts();
    let indices = document["meshes"][0]["primitives"][0]["indices"].as_u64().unwrap() as usize;
    let view = document["accessors"][indices]["bufferView"].as_u64().unwrap() as usize;
    let start = document["bufferViews"][view]["byteOffset"].as_u64().unwrap() as usize;
    binary[start..start + 2].copy_from_slice(&u16::MAX.to_le_bytes());
    let said = SkinnedMesh::from_bytes(&glb(&document, &binary), &rig()).unwrap_err().to_string();
    assert!(said.contains("65535"), "{said}");
}

#[test]
fn colours_of_a_type_that_gltf_does_not_know_are_refused() {
    let message = refused(|document| {
        let attributes = &document["meshes"][0]["primitives"][0]["attributes"];
        let accessor = attributes["COLOR_0"].as_u64().unwrap() as usize;
        document["accessors"][accessor]["componentType"] = 5120.into();
    });
    assert!(message.contains("COLOR_0") && message.contains("I8"), "{message}");
}

#[test]
fn an_attribute_beyond_the_accessors_is_refused() {
    for name in ["POSITION", "NORMAL", "WEIGHTS_0"] {
        let said = refused(|d| d["meshes"][0]["primitives"][0]["attributes"][name] = 9_999.into());
        assert!(said.contains("expected accessors below") && said.contains("9999"), "{said}");
    }
}

#[test]
fn a_header_that_is_shorter_than_itself_is_refused() {
    for length in [0_u32, 4, 11] {
        let mut bytes = HUMANOID_GLB.to_vec();
        bytes[8..12].copy_from_slice(&length.to_le_bytes());
        let said = SkinnedMesh::from_bytes(&bytes, &rig()).unwrap_err().to_string();
        assert!(said.contains("12") && said.contains(&length.to_string()), "{said}");
    }
}

#[test]
fn many_primitives_of_one_accessor_are_refused_before_they_are_read() {
    let said = refused(|d| {
        let primitive = d["meshes"][0]["primitives"][0].clone();
        d["meshes"][0]["primitives"] = vec![primitive; 2_000].into();
    });
    assert!(said.contains("expected at most 2000000 vertices"), "{said}");
}

#[test]
fn every_number_of_the_document_may_be_anything() {
    let (document, binary) = parts();
    let paths = numbers(&document, String::new());
    // Every 7th number, so that the test stays short; the places differ from value to value.
    for (start, value) in [0_i64, -1, 5, 255, 65_535, 4_294_967_295, i64::MAX].into_iter().enumerate() {
        for path in paths.iter().skip(start).step_by(7) {
            let mut changed = document.clone();
            *changed.pointer_mut(path).unwrap() = value.into();
            // Some changes do no harm; none may panic.
            let _ = SkinnedMesh::from_bytes(&glb(&changed, &binary), &rig());
        }
    }
}

/// JSON pointers to the numbers of a document.
fn numbers(value: &serde_json::Value, path: String) -> Vec<String> {
    match value {
        serde_json::Value::Number(_) => vec![path],
        serde_json::Value::Array(all) => {
            all.iter().enumerate().flat_map(|(i, v)| numbers(v, format!("{path}/{i}"))).collect()
        }
        serde_json::Value::Object(all) => {
            all.iter().flat_map(|(k, v)| numbers(v, format!("{path}/{k}"))).collect()
        }
        _ => Vec::new(),
    }
}

#[test]
fn a_document_that_would_fill_the_memory_is_refused_unread() {
    let (mut document, binary) = parts();
    document["materials"] = vec![serde_json::json!({}); 1_000_000].into();
    let bytes = glb(&document, &binary);
    let error = SkinnedMesh::from_bytes(&bytes, &rig()).unwrap_err();
    assert!(matches!(error, MeshError::TooMany { what: "bytes of JSON", .. }), "{error}");
    // Without the four letters the parser takes it for JSON alone.
    let error = SkinnedMesh::from_bytes(&vec![b' '; 3 << 20], &rig()).unwrap_err();
    assert!(matches!(error, MeshError::TooMany { what: "bytes of JSON", .. }), "{error}");
}
