//! Draws a [`Scene`]: characters in one call a material, ground, sky, shadows, markers.
//!
//! A [`Renderer`] is a configuration, immutable pipelines, the mesh and the ground, and buffers that are
//! rewritten for every picture. It draws into any view of the format that it was made for, and knows nothing of
//! windows, physics or panels.

mod appearance;
mod buffers;
mod config;
mod gpu_data;
mod levels;
mod model;
mod off_screen;
mod pipelines;
mod scene;
mod solids;
mod targets;
mod upload;

use crate::gpu::Gpu;
pub use appearance::Appearance;
use buffers::{Growing, GrowingTexture, fixed};
pub use config::{Light, RenderConfig};
use gpu_data::FrameData;
use model::MeshBuffers;
pub use off_screen::OffScreen;
pub use pipelines::SHADERS;
use pipelines::{Layouts, Pipelines};
pub use scene::{Figure, Marker, Part, RibbonVertex, Scene, Solid, View};
pub use solids::{GroundGrid, SolidVertex};
use targets::Targets;
use upload::Counts;

/// Draws scenes. See the module.
#[derive(Debug)]
pub struct Renderer {
    gpu: Gpu,
    config: RenderConfig,
    format: wgpu::TextureFormat,
    layouts: Layouts,
    pipelines: Pipelines,
    appearance: Appearance,
    /// `None` without a mesh.
    mesh_buffers: Option<MeshBuffers>,
    ground: (wgpu::Buffer, u32),
    solids: (wgpu::Buffer, [std::ops::Range<u32>; scene::SOLIDS]),
    shadow_map: wgpu::TextureView,
    shadow_group: wgpu::BindGroup,
    frame: wgpu::Buffer,
    frame_group: wgpu::BindGroup,
    instances: Growing,
    palette: GrowingTexture,
    figures_group: wgpu::BindGroup,
    contacts: Growing,
    markers: Growing,
    things: Growing,
    ribbons: Growing,
    targets: Option<Targets>,
}

impl Renderer {
    /// A renderer for views of `format`, which should not be an sRGB format.
    #[must_use]
    pub fn new(gpu: &Gpu, format: wgpu::TextureFormat, config: RenderConfig, appearance: Appearance) -> Self {
        use wgpu::BufferUsages as Usage;
        let device = &gpu.device;
        let layouts = Layouts::new(device);
        let pipelines = Pipelines::new(device, &layouts, format, &config);
        let mesh_buffers = appearance.mesh().map(|mesh| MeshBuffers::new(device, &layouts, mesh));
        let (solid_vertices, ranges) = solids::solids();
        let shadow_map = targets::shadow_map(device, config.shadow_size);
        let shadow_group = shadow_group(device, &layouts, &shadow_map);
        let frame = fixed(
            device,
            "frame",
            Usage::UNIFORM | Usage::COPY_DST,
            &[<FrameData as bytemuck::Zeroable>::zeroed()],
        );
        let frame_group = bind_buffer(device, &layouts.frame, &frame);
        let instances = Growing::new(device, "instances", Usage::VERTEX);
        let palette = GrowingTexture::new(device, "palette");
        let figures_group = bind_texture(device, &layouts.figures, palette.view());
        Self {
            ground: ground_buffer(device, None),
            solids: (fixed(device, "solids", Usage::VERTEX, &solid_vertices), ranges),
            contacts: Growing::new(device, "contacts", Usage::VERTEX),
            markers: Growing::new(device, "markers", Usage::VERTEX),
            things: Growing::new(device, "things", Usage::VERTEX),
            ribbons: Growing::new(device, "ribbons", Usage::VERTEX),
            targets: None,
            gpu: gpu.clone(),
            config,
            format,
            layouts,
            pipelines,
            appearance,
            mesh_buffers,
            shadow_map,
            shadow_group,
            frame,
            frame_group,
            instances,
            palette,
            figures_group,
        }
    }

    /// How characters are drawn.
    #[must_use]
    pub fn appearance(&self) -> &Appearance {
        &self.appearance
    }

    /// Draws characters in another way from now on.
    pub fn set_appearance(&mut self, appearance: Appearance) {
        let new = |mesh| MeshBuffers::new(&self.gpu.device, &self.layouts, mesh);
        self.mesh_buffers = appearance.mesh().map(new);
        self.appearance = appearance;
    }

    /// Puts other ground under the characters; `None` is flat at height 0.
    pub fn set_ground(&mut self, grid: Option<&GroundGrid>) {
        self.ground = ground_buffer(&self.gpu.device, grid);
    }

    /// Records everything that draws `scene` into `view`, whose size is `size` (width, height).
    pub fn draw(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        view: &wgpu::TextureView,
        size: [u32; 2],
        scene: &Scene,
    ) {
        self.draw_part(encoder, view, (size, Part::whole(size)), scene);
    }

    /// The same into a part of `view`. What is recorded has to be submitted before the next part is.
    pub fn draw_part(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        view: &wgpu::TextureView,
        (size, part): ([u32; 2], Part),
        scene: &Scene,
    ) {
        if part.width == 0 {
            return;
        }
        let counts = self.upload(scene, [part.width, size[1]]);
        if self.targets.as_ref().is_none_or(|t| t.size != size) {
            self.targets = Some(Targets::new(&self.gpu.device, size, self.format, &self.config));
        }
        self.draw_shadows(encoder, &counts);
        self.draw_picture(encoder, view, part, &counts);
    }

    /// Draws `scene` into a picture and reads it back.
    ///
    /// # Errors
    /// When the device is lost.
    pub fn picture(
        &mut self,
        target: &OffScreen,
        scene: &Scene,
    ) -> Result<image::RgbaImage, crate::gpu::GpuError> {
        let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        self.draw(&mut encoder, target.view(), target.size(), scene);
        target.finish(&self.gpu, encoder)
    }

    fn draw_shadows(&self, encoder: &mut wgpu::CommandEncoder, counts: &Counts) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("shadows"),
            depth_stencil_attachment: Some(depth_attachment(&self.shadow_map, wgpu::StoreOp::Store)),
            ..Default::default()
        });
        pass.set_bind_group(0, &self.frame_group, &[]);
        pass.set_pipeline(&self.pipelines.thing_shadow);
        self.draw_solids(&mut pass, &self.things, &counts.things);
        let Some(buffers) = &self.mesh_buffers else { return };
        pass.set_pipeline(&self.pipelines.skinned_shadow);
        pass.set_bind_group(2, &self.figures_group, &[]);
        pass.set_vertex_buffer(1, self.instances.buffer().slice(..));
        for (level, figures) in counts.figures.shadows(buffers.levels.len()) {
            let level = &buffers.levels[level];
            pass.set_vertex_buffer(0, level.vertices.slice(..));
            pass.set_index_buffer(level.indices.slice(..), wgpu::IndexFormat::Uint32);
            let end = level.parts.iter().map(|p| p.1.end).max().unwrap_or(0);
            pass.draw_indexed(0..end, 0, figures);
        }
    }

    fn draw_picture(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        view: &wgpu::TextureView,
        part: Part,
        counts: &Counts,
    ) {
        let targets = self.targets.as_ref().expect("made by draw");
        let (view, resolve_target, store) = match &targets.colour {
            Some(colour) if part.last => (colour, Some(view), wgpu::StoreOp::Discard),
            // The other parts are drawn beside it first.
            Some(colour) => (colour, None, wgpu::StoreOp::Store),
            None => (view, None, wgpu::StoreOp::Store),
        };
        let load = if part.first { wgpu::LoadOp::Clear(wgpu::Color::BLACK) } else { wgpu::LoadOp::Load };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("picture"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target,
                ops: wgpu::Operations { load, store },
            })],
            depth_stencil_attachment: Some(depth_attachment(&targets.depth, wgpu::StoreOp::Discard)),
            ..Default::default()
        });
        let height = targets.size[1];
        pass.set_viewport(part.left as f32, 0.0, part.width as f32, height as f32, 0.0, 1.0);
        pass.set_scissor_rect(part.left, 0, part.width, height);
        pass.set_bind_group(0, &self.frame_group, &[]);
        pass.set_bind_group(1, &self.shadow_group, &[]);
        self.draw_figures(&mut pass, counts);
        pass.set_pipeline(&self.pipelines.thing);
        self.draw_solids(&mut pass, &self.things, &counts.things);
        pass.set_pipeline(&self.pipelines.ground);
        pass.set_vertex_buffer(0, self.ground.0.slice(..));
        pass.draw(0..self.ground.1, 0..1);
        if counts.contacts > 0 {
            pass.set_pipeline(&self.pipelines.contact);
            pass.set_vertex_buffer(0, self.contacts.buffer().slice(..));
            pass.draw(0..4, 0..counts.contacts);
        }
        pass.set_pipeline(&self.pipelines.sky);
        pass.draw(0..3, 0..1);
        if counts.ribbons > 0 {
            pass.set_pipeline(&self.pipelines.ribbon);
            pass.set_vertex_buffer(0, self.ribbons.buffer().slice(..));
            pass.draw(0..counts.ribbons, 0..1);
        }
        pass.set_pipeline(&self.pipelines.shape);
        self.draw_solids(&mut pass, &self.markers, &counts.markers);
    }

    /// One draw call for each kind of solid that there is.
    fn draw_solids(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        placed: &Growing,
        counts: &[std::ops::Range<u32>; scene::SOLIDS],
    ) {
        pass.set_vertex_buffer(0, self.solids.0.slice(..));
        pass.set_vertex_buffer(1, placed.buffer().slice(..));
        for (vertices, instances) in self.solids.1.iter().zip(counts).filter(|(_, some)| !some.is_empty()) {
            pass.draw(vertices.clone(), instances.clone());
        }
    }

    /// One draw call for each material of each level, however many figures there are.
    fn draw_figures(&self, pass: &mut wgpu::RenderPass<'_>, counts: &Counts) {
        let Some(buffers) = &self.mesh_buffers else { return };
        pass.set_pipeline(&self.pipelines.skinned);
        pass.set_bind_group(2, &self.figures_group, &[]);
        pass.set_vertex_buffer(1, self.instances.buffer().slice(..));
        for (level, figures) in buffers.levels.iter().zip(&counts.figures.levels) {
            if figures.is_empty() {
                continue;
            }
            pass.set_vertex_buffer(0, level.vertices.slice(..));
            pass.set_index_buffer(level.indices.slice(..), wgpu::IndexFormat::Uint32);
            for (material, indices) in &level.parts {
                pass.set_bind_group(3, &buffers.materials[*material], &[]);
                pass.draw_indexed(indices.clone(), 0, figures.clone());
            }
        }
    }
}

fn depth_attachment(
    view: &wgpu::TextureView,
    store: wgpu::StoreOp,
) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    let depth_ops = Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store });
    wgpu::RenderPassDepthStencilAttachment { view, depth_ops, stencil_ops: None }
}

fn ground_buffer(device: &wgpu::Device, grid: Option<&GroundGrid>) -> (wgpu::Buffer, u32) {
    let vertices = solids::ground(grid);
    (fixed(device, "ground", wgpu::BufferUsages::VERTEX, &vertices), vertices.len() as u32)
}

fn bind_buffer(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    buffer: &wgpu::Buffer,
) -> wgpu::BindGroup {
    bind(device, layout, buffer.as_entire_binding())
}

fn bind_texture(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    view: &wgpu::TextureView,
) -> wgpu::BindGroup {
    bind(device, layout, wgpu::BindingResource::TextureView(view))
}

fn bind(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    resource: wgpu::BindingResource<'_>,
) -> wgpu::BindGroup {
    let entries = &[wgpu::BindGroupEntry { binding: 0, resource }];
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries })
}

fn shadow_group(device: &wgpu::Device, layouts: &Layouts, map: &wgpu::TextureView) -> wgpu::BindGroup {
    let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("shadow"),
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        compare: Some(wgpu::CompareFunction::LessEqual),
        ..Default::default()
    });
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("shadow"),
        layout: &layouts.shadow,
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(map) },
            wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(&sampler) },
        ],
    })
}
