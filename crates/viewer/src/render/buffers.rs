//! Buffers that grow with what is put into them.

use bytemuck::Pod;

/// A buffer that is rewritten every frame and made anew when it gets too small.
#[derive(Debug)]
pub(super) struct Growing {
    buffer: wgpu::Buffer,
    usage: wgpu::BufferUsages,
    label: &'static str,
}

impl Growing {
    pub(super) fn new(device: &wgpu::Device, label: &'static str, usage: wgpu::BufferUsages) -> Self {
        let usage = usage | wgpu::BufferUsages::COPY_DST;
        Self { buffer: create(device, label, usage, 4096), usage, label }
    }

    /// Replaces the contents; returns true when the buffer is another one now.
    pub(super) fn write<T: Pod>(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, data: &[T]) -> bool {
        let bytes: &[u8] = bytemuck::cast_slice(data);
        let grown = bytes.len() as u64 > self.buffer.size();
        if grown {
            self.buffer = create(device, self.label, self.usage, (bytes.len() as u64).next_power_of_two());
        }
        if !bytes.is_empty() {
            queue.write_buffer(&self.buffer, 0, bytes);
        }
        grown
    }

    pub(super) fn buffer(&self) -> &wgpu::Buffer {
        &self.buffer
    }
}

fn create(device: &wgpu::Device, label: &str, usage: wgpu::BufferUsages, size: u64) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage,
        mapped_at_creation: false,
    })
}

/// A buffer that never changes.
pub(super) fn fixed<T: Pod>(
    device: &wgpu::Device,
    label: &str,
    usage: wgpu::BufferUsages,
    data: &[T],
) -> wgpu::Buffer {
    use wgpu::util::DeviceExt as _;
    let contents = bytemuck::cast_slice(data);
    device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: Some(label), contents, usage })
}

/// Width of a [`GrowingTexture`], texels.
const TEXTURE_WIDTH: u32 = 1024;

/// Four numbers a texel, row by row. Rewritten every frame and made anew when it gets too small.
#[derive(Debug)]
pub(super) struct GrowingTexture {
    texture: wgpu::Texture,
    view: wgpu::TextureView,
    label: &'static str,
}

impl GrowingTexture {
    pub(super) fn new(device: &wgpu::Device, label: &'static str) -> Self {
        Self::with_rows(device, label, 1)
    }

    fn with_rows(device: &wgpu::Device, label: &'static str, rows: u32) -> Self {
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width: TEXTURE_WIDTH, height: rows, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba32Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        Self { texture, view, label }
    }

    /// Replaces the contents; returns true when the texture is another one now.
    pub(super) fn write(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, data: &[[f32; 4]]) -> bool {
        let rows = (data.len() as u32).div_ceil(TEXTURE_WIDTH);
        let grown = rows > self.texture.height();
        if grown {
            *self = Self::with_rows(device, self.label, rows.next_power_of_two());
        }
        // Whole rows, then what is left.
        let (whole, rest) = data.split_at(data.len() - data.len() % TEXTURE_WIDTH as usize);
        let whole_rows = whole.len() as u32 / TEXTURE_WIDTH;
        self.write_rows(queue, 0, [TEXTURE_WIDTH, whole_rows], whole);
        self.write_rows(queue, whole_rows, [rest.len() as u32, 1], rest);
        grown
    }

    fn write_rows(&self, queue: &wgpu::Queue, y: u32, [width, height]: [u32; 2], data: &[[f32; 4]]) {
        if data.is_empty() {
            return;
        }
        let bytes_per_row = Some(width * size_of::<[f32; 4]>() as u32);
        queue.write_texture(
            wgpu::TexelCopyTextureInfo {
                origin: wgpu::Origin3d { x: 0, y, z: 0 },
                ..self.texture.as_image_copy()
            },
            bytemuck::cast_slice(data),
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row, rows_per_image: None },
            wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        );
    }

    pub(super) fn view(&self) -> &wgpu::TextureView {
        &self.view
    }
}
