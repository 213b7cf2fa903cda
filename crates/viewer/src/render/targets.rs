//! What is drawn into besides the picture itself.

use super::config::RenderConfig;
use super::pipelines::DEPTH;

/// Multisampled colour and depth of one picture size.
#[derive(Debug)]
pub(super) struct Targets {
    pub(super) size: [u32; 2],
    /// `None` when the picture has one sample a pixel and is drawn into directly.
    pub(super) colour: Option<wgpu::TextureView>,
    pub(super) depth: wgpu::TextureView,
}

impl Targets {
    pub(super) fn new(
        device: &wgpu::Device,
        size: [u32; 2],
        format: wgpu::TextureFormat,
        config: &RenderConfig,
    ) -> Self {
        let attachment = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let colour = (config.samples > 1).then(|| texture(device, size, config.samples, format, attachment));
        let depth = texture(device, size, config.samples, DEPTH, attachment);
        Self { size, colour, depth }
    }
}

pub(super) fn shadow_map(device: &wgpu::Device, side: u32) -> wgpu::TextureView {
    let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
    texture(device, [side, side], 1, DEPTH, usage)
}

fn texture(
    device: &wgpu::Device,
    [width, height]: [u32; 2],
    sample_count: u32,
    format: wgpu::TextureFormat,
    usage: wgpu::TextureUsages,
) -> wgpu::TextureView {
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    });
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}
