//! From a [`Scene`] to the buffers of one picture.

use super::gpu_data::{ContactData, FrameData, InstanceData, MarkerData, contacts};
use super::levels::Arranged;
use super::scene::SOLIDS;
use super::{Marker, Renderer, Scene, Solid, bind_texture};

/// Numbers of what one picture draws, filled in by the upload.
pub(super) struct Counts {
    pub(super) figures: Arranged,
    pub(super) contacts: u32,
    pub(super) markers: [std::ops::Range<u32>; SOLIDS],
    pub(super) things: [std::ops::Range<u32>; SOLIDS],
    pub(super) ribbons: u32,
}

impl Renderer {
    /// Writes everything that changes from picture to picture.
    pub(super) fn upload(&mut self, scene: &Scene, [width, height]: [u32; 2]) -> Counts {
        let (device, queue) = (&self.gpu.device, &self.gpu.queue);
        let aspect = width as f32 / height.max(1) as f32;
        queue.write_buffer(&self.frame, 0, bytemuck::bytes_of(&FrameData::new(scene, aspect, &self.config)));

        let mesh = self.appearance.mesh();
        let detail =
            self.mesh_buffers.as_ref().map_or((0, 0.0), |buffers| (buffers.levels.len(), buffers.metres));
        let figures = Arranged::new(scene, [width, height], &self.config, detail);
        let joints = mesh.map_or(0, |mesh| mesh.joints.len());
        let mut palette = Vec::with_capacity(figures.order.len() * joints);
        let mut instances = Vec::with_capacity(figures.order.len());
        for figure in figures.order.iter().map(|index| &scene.figures[*index]) {
            let first = palette.len() as u32;
            instances.push(InstanceData { tint: figure.tint, ground: figure.ground, first });
            if let Some(mesh) = mesh {
                mesh.palette_into(&figure.positions, &figure.rotations, &mut palette);
            }
        }
        let mut patches: Vec<ContactData> = Vec::new();
        for figure in &scene.figures {
            contacts(&self.appearance.patches, figure, &mut patches);
        }
        self.instances.write(device, queue, &instances);
        if self.palette.write(device, queue, palette.as_flattened()) {
            self.figures_group = bind_texture(device, &self.layouts.figures, self.palette.view());
        }
        self.contacts.write(device, queue, &patches);
        self.ribbons.write(device, queue, &scene.ribbons);
        let (instances_of_markers, markers) = by_solid(&scene.markers);
        self.markers.write(device, queue, &instances_of_markers);
        let (instances_of_things, things) = by_solid(&scene.things);
        self.things.write(device, queue, &instances_of_things);
        Counts {
            figures,
            contacts: patches.len() as u32,
            markers,
            things,
            ribbons: scene.ribbons.len() as u32,
        }
    }
}

/// All of them, those of one solid side by side, and the range of each solid.
fn by_solid(all: &[Marker]) -> (Vec<MarkerData>, [std::ops::Range<u32>; SOLIDS]) {
    let mut sorted = Vec::with_capacity(all.len());
    let ranges = Solid::ALL.map(|solid| {
        let start = sorted.len() as u32;
        let of_kind = all.iter().filter(|m| m.solid == solid);
        sorted.extend(of_kind.map(|m| MarkerData::new(m.place, m.colour)));
        start..sorted.len() as u32
    });
    (sorted, ranges)
}
