//! Opens an adapter: the best there is, a software one where there is none better.

use std::sync::{Arc, OnceLock};

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
    /// The device went away again soon after it was opened anew.
    #[error("the device of {adapter} was lost again within {seconds:.0} s of being opened anew: {reason}")]
    LostAgain {
        /// Name of the adapter.
        adapter: String,
        /// Seconds since the loss before.
        seconds: f32,
        /// What the driver said.
        reason: String,
    },
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
    /// Why the device is of no use any more, once it is not.
    lost: Arc<OnceLock<String>>,
}

impl Gpu {
    /// Opens a device that draws into pictures only.
    ///
    /// # Errors
    /// When there is no adapter or it gives no device.
    pub fn off_screen() -> Result<Self, GpuError> {
        let instance = wgpu::Instance::new(descriptor());
        pollster::block_on(Self::open(&instance, None)).map(|(gpu, _)| gpu)
    }

    /// Opens a device that can draw into `target`, a window say; also returns the surface and its adapter.
    ///
    /// # Errors
    /// When the target gives no surface, and as [`Gpu::off_screen`].
    pub fn for_window(
        target: impl Into<wgpu::SurfaceTarget<'static>>,
    ) -> Result<(Self, wgpu::Surface<'static>, wgpu::Adapter), GpuError> {
        pollster::block_on(Self::for_target(target))
    }

    /// The same without waiting, for browsers.
    ///
    /// # Errors
    /// As [`Gpu::for_window`].
    pub async fn for_target(
        target: impl Into<wgpu::SurfaceTarget<'static>>,
    ) -> Result<(Self, wgpu::Surface<'static>, wgpu::Adapter), GpuError> {
        // In a browser without WebGPU the canvas has to be opened by WebGL2 from the start.
        let instance = wgpu::util::new_instance_with_webgpu_detection(descriptor()).await;
        let surface = instance.create_surface(target).map_err(GpuError::NoSurface)?;
        let (gpu, adapter) = Self::open(&instance, Some(&surface)).await?;
        Ok((gpu, surface, adapter))
    }

    async fn open(
        instance: &wgpu::Instance,
        surface: Option<&wgpu::Surface<'_>>,
    ) -> Result<(Self, wgpu::Adapter), GpuError> {
        let options = |force_fallback_adapter| wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            force_fallback_adapter,
            compatible_surface: surface,
            ..Default::default()
        };
        let adapter = match instance.request_adapter(&options(false)).await {
            Ok(adapter) => adapter,
            Err(_) => instance.request_adapter(&options(true)).await.map_err(GpuError::NoAdapter)?,
        };
        let info = adapter.get_info();
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("policy space"),
            // Nothing here computes or stores, so that WebGL2 will do.
            required_limits: wgpu::Limits::downlevel_webgl2_defaults().using_resolution(adapter.limits()),
            memory_hints: wgpu::MemoryHints::MemoryUsage,
            ..Default::default()
        };
        let (device, queue) = adapter
            .request_device(&descriptor)
            .await
            .map_err(|source| GpuError::NoDevice { adapter: info.name.clone(), source })?;
        // A browser does not say what kind of adapter it has, at most its name.
        let is_software = info.device_type == wgpu::DeviceType::Cpu || info.name.contains("SwiftShader");
        let lost = watch(&device);
        // Browsers name no adapter.
        let adapter_name = if info.name.is_empty() { format!("{:?}", info.backend) } else { info.name };
        Ok((Self { device, queue, adapter_name, is_software, lost }, adapter))
    }

    /// Why the device went away, once it has: by a reset of the driver, a card that was unplugged, or for want of
    /// memory. Whatever was made with it is of no use then.
    #[must_use]
    pub fn lost(&self) -> Option<&str> {
        self.lost.get().map(String::as_str)
    }
}

/// Notes the first thing that makes `device` useless. What is wrong with our own calls still panics.
fn watch(device: &wgpu::Device) -> Arc<OnceLock<String>> {
    let lost = Arc::new(OnceLock::new());
    let note = {
        let lost = Arc::clone(&lost);
        move |reason: String| {
            // Only the first reason counts: others follow from it.
            let _ = lost.set(reason);
        }
    };
    device.set_device_lost_callback({
        let note = note.clone();
        move |reason, message| note(format!("{reason:?} {message}").trim_end().into())
    });
    device.on_uncaptured_error(Arc::new(move |error| match error {
        wgpu::Error::Validation { .. } => panic!("{error}"),
        other => note(other.to_string()),
    }));
    lost
}

fn descriptor() -> wgpu::InstanceDescriptor {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = wgpu::Backends::PRIMARY | wgpu::Backends::GL;
    descriptor
}
