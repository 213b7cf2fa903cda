//! Opens an adapter: the best there is, a software one where there is none better.

use std::sync::Arc;

/// Why nothing can be drawn.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GpuError {
    /// No adapter at all.
    #[error(
        "expected a Vulkan or OpenGL adapter, found none; mesa-vulkan-drivers brings a software one: {0}"
    )]
    NoAdapter(wgpu::RequestAdapterError),
    /// The adapter gives no device.
    #[error("the adapter {adapter} gives no device: {source}")]
    NoDevice {
        /// Name of the adapter.
        adapter: String,
        /// What it said.
        source: wgpu::RequestDeviceError,
    },
    /// The window can't be drawn into.
    #[error("the window gives no surface: {0}")]
    NoSurface(wgpu::CreateSurfaceError),
    /// The device went away while a picture was read back.
    #[error("the device was lost while reading a picture back")]
    Lost,
}

/// A device to draw with. Cloning shares it.
#[derive(Clone, Debug)]
pub struct Gpu {
    /// Commands go here.
    pub device: wgpu::Device,
    /// And are sent from here.
    pub queue: wgpu::Queue,
    /// What the adapter calls itself, such as `llvmpipe (LLVM 15.0.6, 256 bits)`.
    pub adapter_name: String,
    /// True when the processor draws.
    pub is_software: bool,
}

impl Gpu {
    /// Opens a device that draws into pictures only.
    ///
    /// # Errors
    /// When there is no adapter or it gives no device.
    pub fn off_screen() -> Result<Self, GpuError> {
        let instance = wgpu::Instance::new(descriptor());
        Self::open(&instance, None).map(|(gpu, _)| gpu)
    }

    /// Opens a device that can draw into `window`; also answers the surface and its adapter.
    ///
    /// # Errors
    /// When the window gives no surface, and as [`Gpu::off_screen`].
    pub fn for_window(
        window: Arc<winit::window::Window>,
    ) -> Result<(Self, wgpu::Surface<'static>, wgpu::Adapter), GpuError> {
        let instance = wgpu::Instance::new(descriptor());
        let surface = instance.create_surface(window).map_err(GpuError::NoSurface)?;
        let (gpu, adapter) = Self::open(&instance, Some(&surface))?;
        Ok((gpu, surface, adapter))
    }

    fn open(
        instance: &wgpu::Instance,
        surface: Option<&wgpu::Surface<'_>>,
    ) -> Result<(Self, wgpu::Adapter), GpuError> {
        let request = |force_fallback_adapter| {
            pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions {
                power_preference: wgpu::PowerPreference::HighPerformance,
                force_fallback_adapter,
                compatible_surface: surface,
                ..Default::default()
            }))
        };
        let adapter = request(false).or_else(|_| request(true)).map_err(GpuError::NoAdapter)?;
        let info = adapter.get_info();
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("policy space"),
            required_limits: wgpu::Limits::downlevel_defaults().using_resolution(adapter.limits()),
            memory_hints: wgpu::MemoryHints::MemoryUsage,
            ..Default::default()
        }))
        .map_err(|source| GpuError::NoDevice { adapter: info.name.clone(), source })?;
        let is_software = info.device_type == wgpu::DeviceType::Cpu;
        Ok((Self { device, queue, adapter_name: info.name, is_software }, adapter))
    }
}

fn descriptor() -> wgpu::InstanceDescriptor {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = wgpu::Backends::PRIMARY | wgpu::Backends::GL;
    descriptor
}
