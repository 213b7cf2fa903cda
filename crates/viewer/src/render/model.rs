//! A [`SkinnedMesh`] in the device's memory.

use glam::Vec3;

use super::buffers::fixed;
use super::pipelines::Layouts;
use crate::mesh::{Level, Material, SkinnedMesh};

#[derive(Debug)]
pub(super) struct LevelBuffers {
    pub(super) vertices: wgpu::Buffer,
    pub(super) indices: wgpu::Buffer,
    /// Range of indices by material.
    pub(super) parts: Vec<(usize, std::ops::Range<u32>)>,
}

#[derive(Debug)]
pub(super) struct MeshBuffers {
    /// Finest first.
    pub(super) levels: Vec<LevelBuffers>,
    /// The longest side of the mesh as it stands, metres.
    pub(super) metres: f32,
    pub(super) materials: Vec<wgpu::BindGroup>,
}

impl MeshBuffers {
    pub(super) fn new(device: &wgpu::Device, layouts: &Layouts, mesh: &SkinnedMesh) -> Self {
        Self {
            levels: mesh.levels.iter().map(|level| level_buffers(device, level)).collect(),
            metres: mesh.levels.first().map_or(0.0, longest_side),
            materials: mesh.materials.iter().map(|material| bind(device, layouts, material)).collect(),
        }
    }
}

fn longest_side(level: &Level) -> f32 {
    let corners = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    let (low, high) = level.vertices.iter().fold(corners, |(low, high), vertex| {
        (low.min(vertex.position.into()), high.max(vertex.position.into()))
    });
    (high - low).max_element().max(0.0)
}

fn level_buffers(device: &wgpu::Device, level: &Level) -> LevelBuffers {
    LevelBuffers {
        vertices: fixed(device, "mesh vertices", wgpu::BufferUsages::VERTEX, &level.vertices),
        indices: fixed(device, "mesh indices", wgpu::BufferUsages::INDEX, &level.indices),
        parts: level.parts.iter().map(|part| (part.material, part.indices.clone())).collect(),
    }
}

fn bind(device: &wgpu::Device, layouts: &Layouts, material: &Material) -> wgpu::BindGroup {
    let [r, g, b] = material.colour;
    let tinted = f32::from(u8::from(material.tinted));
    let data = [r, g, b, material.roughness, material.metallic, tinted, 0.0, 0.0];
    let buffer = fixed(device, "material", wgpu::BufferUsages::UNIFORM, &data);
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("material"),
        layout: &layouts.material,
        entries: &[wgpu::BindGroupEntry { binding: 0, resource: buffer.as_entire_binding() }],
    })
}
