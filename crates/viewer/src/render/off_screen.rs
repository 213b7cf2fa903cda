//! Pictures without a window: a texture to draw into and the way back to memory.

use image::RgbaImage;

use crate::gpu::{Gpu, GpuError};

/// A picture in the device's memory that can be read back.
#[derive(Debug)]
pub struct OffScreen {
    texture: wgpu::Texture,
    view: wgpu::TextureView,
    buffer: wgpu::Buffer,
    size: [u32; 2],
}

impl OffScreen {
    /// Format of the picture: what [`Renderer`](super::Renderer) must be made for.
    pub const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

    /// A picture of `size` (width, height), at least one pixel each way.
    #[must_use]
    pub fn new(gpu: &Gpu, size: [u32; 2]) -> Self {
        Self::with_format(gpu, size, Self::FORMAT)
    }

    /// The same in another format of four bytes a pixel, red first or blue first.
    #[must_use]
    pub fn with_format(gpu: &Gpu, size: [u32; 2], format: wgpu::TextureFormat) -> Self {
        let size = size.map(|s| s.max(1));
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("off screen"),
            size: extent(size),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("readback"),
            size: u64::from(stride(size) * size[1]),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        Self { texture, view, buffer, size }
    }

    /// What to draw into.
    #[must_use]
    pub fn view(&self) -> &wgpu::TextureView {
        &self.view
    }

    /// Width and height.
    #[must_use]
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Sends what `encoder` holds, waits for it and reads the picture back.
    ///
    /// # Errors
    /// [`GpuError::Lost`] when the device went away.
    pub fn finish(&self, gpu: &Gpu, mut encoder: wgpu::CommandEncoder) -> Result<RgbaImage, GpuError> {
        encoder.copy_texture_to_buffer(
            self.texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &self.buffer,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(stride(self.size)),
                    rows_per_image: None,
                },
            },
            extent(self.size),
        );
        gpu.queue.submit([encoder.finish()]);
        let (sender, receiver) = std::sync::mpsc::channel();
        self.buffer.map_async(wgpu::MapMode::Read, .., move |mapped| {
            // The receiver is gone only when this function has already returned an error.
            let _ = sender.send(mapped);
        });
        gpu.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|_| GpuError::Lost)?;
        receiver.recv().map_err(|_| GpuError::Lost)?.map_err(|_| GpuError::Lost)?;
        let pixels = {
            let mapped = self.buffer.get_mapped_range(..).map_err(|_| GpuError::Lost)?;
            let row = self.size[0] as usize * 4;
            let rows = mapped.chunks_exact(stride(self.size) as usize);
            rows.flat_map(|padded| &padded[..row]).copied().collect()
        };
        let mut pixels: Vec<u8> = pixels;
        if self.texture.format().remove_srgb_suffix() == wgpu::TextureFormat::Bgra8Unorm {
            pixels.chunks_exact_mut(4).for_each(|pixel| pixel.swap(0, 2));
        }
        self.buffer.unmap();
        Ok(RgbaImage::from_raw(self.size[0], self.size[1], pixels).expect("rows times width times four"))
    }
}

fn extent([width, height]: [u32; 2]) -> wgpu::Extent3d {
    wgpu::Extent3d { width, height, depth_or_array_layers: 1 }
}

/// Bytes of a row in the buffer, as copies want them aligned.
fn stride([width, _]: [u32; 2]) -> u32 {
    (width * 4).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT)
}
