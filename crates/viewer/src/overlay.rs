//! Draws panels over a picture: egui's shapes through wgpu, for a window and off screen.

use crate::gpu::Gpu;

/// What egui wants drawn, ready for the device.
#[derive(Debug)]
pub struct Prepared {
    primitives: Vec<egui::ClippedPrimitive>,
    textures: egui::TexturesDelta,
    pixels_per_point: f32,
}

impl Prepared {
    /// Takes over the output of a pass.
    #[must_use]
    pub fn new(context: &egui::Context, output: egui::FullOutput) -> Self {
        let pixels_per_point = output.pixels_per_point;
        let primitives = context.tessellate(output.shapes, pixels_per_point);
        Self { primitives, textures: output.textures_delta, pixels_per_point }
    }
}

/// Panels on top of pictures of one format.
pub struct Overlay {
    gpu: Gpu,
    renderer: egui_wgpu::Renderer,
}

impl std::fmt::Debug for Overlay {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Overlay").finish_non_exhaustive()
    }
}

impl Overlay {
    /// For views of `format`.
    #[must_use]
    pub fn new(gpu: &Gpu, format: wgpu::TextureFormat) -> Self {
        let options = egui_wgpu::RendererOptions::default();
        Self { gpu: gpu.clone(), renderer: egui_wgpu::Renderer::new(&gpu.device, format, options) }
    }

    /// Uploads textures that panels changed. Once for each [`Prepared`], before it is drawn.
    pub fn upload(&mut self, prepared: &mut Prepared) {
        for (id, deltas) in prepared.textures.set.drain() {
            for delta in &deltas {
                self.renderer.update_texture(&self.gpu.device, &self.gpu.queue, id, delta);
            }
        }
    }

    /// Frees textures that no panel needs any more. After the last drawing of it.
    pub fn free(&mut self, prepared: &mut Prepared) {
        for id in prepared.textures.free.drain() {
            self.renderer.free_texture(&id);
        }
    }

    /// Records everything that draws `prepared` over what is in `view`, whose size is `size`.
    pub fn draw(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        view: &wgpu::TextureView,
        size: [u32; 2],
        prepared: &Prepared,
    ) {
        let screen =
            egui_wgpu::ScreenDescriptor { size_in_pixels: size, pixels_per_point: prepared.pixels_per_point };
        let (device, queue) = (&self.gpu.device, &self.gpu.queue);
        let more = self.renderer.update_buffers(device, queue, encoder, &prepared.primitives, &screen);
        queue.submit(more);
        let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("panels"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store },
            })],
            ..Default::default()
        });
        self.renderer.render(&mut pass.forget_lifetime(), &prepared.primitives, &screen);
    }
}
