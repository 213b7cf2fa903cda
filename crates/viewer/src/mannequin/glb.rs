//! Writes the mannequin as glTF 2.0 binary: nodes that carry the body names, one skin, two materials, and a mesh for each level of
//! detail (the coarser ones called `mannequin_lod1` and so on).
//!
//! glTF is y up and faces z; the character is z up and faces x: `(x, y, z)` becomes `(y, z, x)`.

use glam::Vec3;
use serde_json::{Value, json};

use super::anatomy::{REST_OFFSETS, rest_positions};
use super::bone::{BONE_NAMES, Bone};
use super::sculpt::Part;

const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;
const UNSIGNED_BYTE: u32 = 5121;
const UNSIGNED_SHORT: u32 = 5123;
const FLOAT: u32 = 5126;
/// Height of the pelvis above the soles with all joints at zero.
const STANDING: f32 = 0.881_416;

fn gltf_from_world(v: Vec3) -> [f32; 3] {
    [v.y, v.z, v.x]
}

#[derive(Default)]
struct Writer {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Writer {
    /// Adds an accessor with a buffer view of its own; returns its index.
    fn accessor(&mut self, data: &[u8], target: Option<u32>, mut accessor: Value) -> usize {
        let mut view = json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": data.len() });
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        self.bytes.extend_from_slice(data);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        accessor["bufferView"] = json!(self.views.len());
        self.views.push(view);
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    fn primitive(&mut self, part: &Part, material: usize) -> Value {
        let count = part.vertices.len();
        let positions: Vec<[f32; 3]> = part.vertices.iter().map(|v| gltf_from_world(v.position)).collect();
        let normals: Vec<[f32; 3]> = part.vertices.iter().map(|v| gltf_from_world(v.normal)).collect();
        let colours: Vec<[u8; 4]> = part.vertices.iter().map(|v| grey(v.openness)).collect();
        let joints: Vec<[u8; 4]> = part.vertices.iter().map(|v| v.bodies).collect();
        let follow: Vec<[u8; 4]> = part.vertices.iter().map(|v| v.follow).collect();
        let low = positions.iter().fold([f32::INFINITY; 3], |a, p| [0, 1, 2].map(|i| a[i].min(p[i])));
        let high = positions.iter().fold([f32::NEG_INFINITY; 3], |a, p| [0, 1, 2].map(|i| a[i].max(p[i])));
        let vec3 = json!({ "componentType": FLOAT, "count": count, "type": "VEC3" });
        let bytes4 = json!({ "componentType": UNSIGNED_BYTE, "count": count, "type": "VEC4" });
        let mut bounded = vec3.clone();
        bounded["min"] = json!(low);
        bounded["max"] = json!(high);
        let mut normalized = bytes4.clone();
        normalized["normalized"] = json!(true);
        let array = Some(ARRAY_BUFFER);
        let attributes = json!({
            "POSITION": self.accessor(bytemuck::cast_slice(&positions), array, bounded),
            "NORMAL": self.accessor(bytemuck::cast_slice(&normals), array, vec3),
            "COLOR_0": self.accessor(bytemuck::cast_slice(&colours), array, normalized.clone()),
            "JOINTS_0": self.accessor(bytemuck::cast_slice(&joints), array, bytes4),
            "WEIGHTS_0": self.accessor(bytemuck::cast_slice(&follow), array, normalized),
        });
        assert!(count <= usize::from(u16::MAX), "the mannequin fits 16-bit indices");
        let indices: Vec<u16> = part.indices.iter().map(|&i| i as u16).collect();
        let scalar = json!({ "componentType": UNSIGNED_SHORT, "count": indices.len(), "type": "SCALAR" });
        let indices = self.accessor(bytemuck::cast_slice(&indices), Some(ELEMENT_ARRAY_BUFFER), scalar);
        json!({ "attributes": attributes, "indices": indices, "material": material })
    }

    fn inverse_bind_matrices(&mut self) -> usize {
        let matrices: Vec<[f32; 16]> = rest_positions()
            .iter()
            .map(|&p| {
                let [x, y, z] = gltf_from_world(-p);
                [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, x, y, z, 1.0]
            })
            .collect();
        let layout = json!({ "componentType": FLOAT, "count": matrices.len(), "type": "MAT4" });
        self.accessor(bytemuck::cast_slice(&matrices), None, layout)
    }
}

fn grey(openness: f32) -> [u8; 4] {
    let level = (openness * 255.0 + 0.5) as u8;
    [level, level, level, 255]
}

/// Bytes of the `.glb` file; `levels` holds shells and suit from fine to coarse.
pub(super) fn write(levels: &[(Part, Part)]) -> Vec<u8> {
    let mut writer = Writer::default();
    let mut meshes = Vec::new();
    for (level, (shells, suit)) in levels.iter().enumerate() {
        let primitives = [writer.primitive(shells, 0), writer.primitive(suit, 1)];
        let name = if level == 0 { "mannequin".to_owned() } else { format!("mannequin_lod{level}") };
        meshes.push(json!({ "name": name, "primitives": primitives }));
    }
    let inverse_bind = writer.inverse_bind_matrices();
    let joints: Vec<usize> = (0..BONE_NAMES.len()).collect();
    let document = json!({
        "asset": { "version": "2.0", "generator": "Policy Space mannequin" },
        "scene": 0,
        "scenes": [{ "name": "humanoid", "nodes": [0, BONE_NAMES.len()] }],
        "nodes": nodes(),
        "meshes": meshes,
        "skins": [{ "name": "humanoid", "joints": joints, "skeleton": 0, "inverseBindMatrices": inverse_bind }],
        "materials": [
            material("shell", [0.80, 0.765, 0.70, 1.0], 0.38),
            material("suit", [0.022, 0.025, 0.032, 1.0], 0.40),
        ],
        "accessors": writer.accessors,
        "bufferViews": writer.views,
        "buffers": [{ "byteLength": writer.bytes.len() }],
    });
    container(&document, &writer.bytes)
}

fn nodes() -> Vec<Value> {
    let mut nodes: Vec<Value> = Bone::ALL
        .iter()
        .map(|body| {
            let children: Vec<usize> =
                Bone::ALL.iter().filter(|b| b.parent() == Some(*body)).map(|b| b.index()).collect();
            let mut offset = REST_OFFSETS[body.index()];
            if *body == Bone::Pelvis {
                offset.z = STANDING;
            }
            let mut node = json!({ "name": body.name(), "translation": gltf_from_world(offset) });
            if !children.is_empty() {
                node["children"] = json!(children);
            }
            node
        })
        .collect();
    nodes.push(json!({ "name": "mannequin", "mesh": 0, "skin": 0 }));
    nodes
}

fn material(name: &str, colour: [f32; 4], roughness: f32) -> Value {
    let surface = json!({ "baseColorFactor": colour, "metallicFactor": 0.0, "roughnessFactor": roughness });
    json!({ "name": name, "pbrMetallicRoughness": surface })
}

fn container(document: &Value, binary: &[u8]) -> Vec<u8> {
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let total = 12 + 8 + text.len() + 8 + binary.len();
    let mut bytes = Vec::with_capacity(total);
    bytes.extend_from_slice(b"glTF");
    bytes.extend_from_slice(&2_u32.to_le_bytes());
    bytes.extend_from_slice(&(total as u32).to_le_bytes());
    bytes.extend_from_slice(&(text.len() as u32).to_le_bytes());
    bytes.extend_from_slice(b"JSON");
    bytes.extend_from_slice(&text);
    bytes.extend_from_slice(&(binary.len() as u32).to_le_bytes());
    bytes.extend_from_slice(b"BIN\0");
    bytes.extend_from_slice(binary);
    bytes
}
