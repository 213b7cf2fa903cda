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
mod passes;
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
