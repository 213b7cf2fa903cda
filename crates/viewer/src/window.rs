//! The demo in a window: events in, frames out. The demo survives the loss of surface and device.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use anyhow::Context as _;
use winit::application::ApplicationHandler;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop};
use winit::window::{Window, WindowId};

use crate::app::{App, KeptLayout, ViewerCommand};
use crate::cli::pad_input::PadInput;
use crate::cli::{Demo, replay_files};
use crate::frame_composer::FrameComposer;
use crate::gpu::{Gpu, GpuError};
use crate::pads::Pads;
use crate::recorder::RecorderError;
use crate::render::Appearance;
use crate::signals;
use crate::sound::Speaker;

/// A device that is lost twice within this time will be lost again.
const LOSSES_APART: Duration = Duration::from_secs(10);

/// Least size of the window, points: the bar, one column of panels and a view beside it.
const LEAST_SIZE: [u32; 2] = [800, 500];

/// Runs the demo until its window is closed.
///
/// # Errors
/// When there is no display or nothing to draw with.
pub fn run(demo: &Demo, mut app: App, appearance: Appearance, layout: Option<PathBuf>) -> anyhow::Result<()> {
    let events = EventLoop::new().context("no display: set DISPLAY or WAYLAND_DISPLAY, or use --headless")?;
    events.set_control_flow(ControlFlow::Poll);
    let scripted = Scripted::load(demo)?;
    let pads = if demo.no_pad || scripted.is_some() { None } else { Some(Pads::start()) };
    app.is_scripted = scripted.is_some();
    let mut host = Host {
        pads,
        scripted,
        layout: layout.map(|path| KeptLayout::new(path, &app.layout)),
        app,
        appearance: Some(appearance),
        size: demo.size,
        trace: demo.trace,
        speaker: Speaker::start(),
        window: None,
        lost: None,
        failed: None,
    };
    let ran = events.run_app(&mut host).map_err(anyhow::Error::from);
    // Everything is written that can be; the first error is told.
    let films = host.window.map_or(Ok(()), |open| open.composer.finish());
    let replay = replay_files::end(demo, &host.app);
    let layout = host.layout.map_or(Ok(()), |mut kept| kept.keep(&host.app.layout));
    ran.and(host.failed.map_or(Ok(()), Err))
        .and(films.map_err(Into::into))
        .and(replay)
        .and(layout.map_err(Into::into))
}

/// Pads that the command line gives instead of devices, in the time of the world.
struct Scripted {
    first: PadInput,
    second: Option<PadInput>,
}

impl Scripted {
    fn load(demo: &Demo) -> anyhow::Result<Option<Self>> {
        let (first, second) = (PadInput::load(demo)?, PadInput::load_second(demo)?);
        Ok((first.is_given() || second.is_some()).then_some(Self { first, second }))
    }

    fn poll(&mut self, app: &mut App) {
        let now = app.sim.ticks() as f64 * f64::from(app.sim.tick_secs());
        let pad = self.first.state_at(now);
        (app.pad.raw, app.pad.state) = (pad, pad);
        app.pad.name = self.first.is_given().then(|| "a script".into());
        app.pad.second = self.second.as_mut().map(|second| second.state_at(now));
    }
}

/// What the event loop calls.
struct Host {
    app: App,
    pads: Option<Pads>,
    scripted: Option<Scripted>,
    layout: Option<KeptLayout>,
    appearance: Option<Appearance>,
    size: [u32; 2],
    trace: bool,
    speaker: Speaker,
    window: Option<OpenWindow>,
    /// When the device was lost last.
    lost: Option<Instant>,
    failed: Option<anyhow::Error>,
}

impl Host {
    /// Opens the device anew when it was lost, with all that was made with it; the world does not notice.
    fn replace_lost_device(&mut self) -> anyhow::Result<()> {
        let Some(open) = self.window.take_if(|open| open.gpu.lost().is_some()) else { return Ok(()) };
        let (adapter, reason) =
            (open.gpu.adapter_name.clone(), open.gpu.lost().unwrap_or_default().to_owned());
        if let Some(since) = self.lost.map(|at| at.elapsed()).filter(|since| *since < LOSSES_APART) {
            return Err(GpuError::LostAgain { adapter, seconds: since.as_secs_f32(), reason }.into());
        }
        self.lost = Some(Instant::now());
        let (window, appearance, films) = open.close();
        if let Err(error) = films {
            self.app.toasts.error(error.to_string());
        }
        (self.app.ground_changed, self.app.recording) = (true, None);
        self.window = Some(OpenWindow::on(window, appearance, &mut self.app)?);
        self.app.toasts.error(format!("The graphics device ({adapter}) failed and was restarted: {reason}"));
        Ok(())
    }
}

/// What there is once the window is.
struct OpenWindow {
    window: Arc<Window>,
    surface: wgpu::Surface<'static>,
    configuration: wgpu::SurfaceConfiguration,
    gpu: Gpu,
    composer: FrameComposer,
    egui: egui_winit::State,
    last: Instant,
    traced: Instant,
}

impl ApplicationHandler for Host {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        let Some(appearance) = self.appearance.take() else { return };
        match OpenWindow::new(events, self.size, appearance, &mut self.app) {
            Ok(open) => self.window = Some(open),
            Err(error) => {
                self.failed = Some(error);
                events.exit();
            }
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        if let Err(error) = self.replace_lost_device() {
            self.failed = Some(error);
            return events.exit();
        }
        let Some(open) = &mut self.window else { return };
        // egui tells what it wants through its own context; nothing needs the answer.
        let _ = open.egui.on_window_event(&open.window, &event);
        match event {
            WindowEvent::CloseRequested => events.exit(),
            WindowEvent::Resized(size) => open.resize([size.width, size.height]),
            WindowEvent::DroppedFile(path) => self.app.dropped.push(path),
            WindowEvent::RedrawRequested => {
                if let Some(pads) = &mut self.pads
                    && pads.poll(&mut self.app.pad, self.app.sim.has_second_character())
                {
                    self.app.apply(ViewerCommand::Pause(!self.app.clock.paused));
                }
                if let Some(scripted) = &mut self.scripted {
                    scripted.poll(&mut self.app);
                }
                open.frame(&mut self.app, self.trace);
                self.app.speaker = self.speaker.state();
                self.speaker.play(self.app.ear.take(), self.app.layout.preferences.loudness());
                if self.app.quit {
                    events.exit();
                }
            }
            _ => {}
        }
    }

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        if signals::received().is_some() {
            return events.exit();
        }
        if let Some(Err(error)) = self.layout.as_mut().map(|kept| kept.keep(&self.app.layout)) {
            self.app.toasts.error(error.to_string());
        }
        if let Some(open) = &self.window {
            open.window.request_redraw();
        }
    }
}

impl OpenWindow {
    fn new(
        events: &ActiveEventLoop,
        size: [u32; 2],
        appearance: Appearance,
        app: &mut App,
    ) -> anyhow::Result<Self> {
        // Who asks for a smaller window gets it.
        let least = winit::dpi::LogicalSize::new(size[0].min(LEAST_SIZE[0]), size[1].min(LEAST_SIZE[1]));
        let size = winit::dpi::LogicalSize::new(size[0], size[1]);
        let attributes = Window::default_attributes()
            .with_title("Policy Space")
            .with_inner_size(size)
            .with_min_inner_size(least);
        let window = Arc::new(events.create_window(attributes).context("the system gives no window")?);
        Self::on(window, appearance, app)
    }

    /// Everything but the window.
    fn on(window: Arc<Window>, appearance: Appearance, app: &mut App) -> anyhow::Result<Self> {
        let (gpu, surface, adapter) = Gpu::for_window(Arc::clone(&window))?;
        let size = window.inner_size();
        let [width, height] = drawable([size.width, size.height], &gpu);
        let mut configuration = surface
            .get_default_config(&adapter, width, height)
            .context("the adapter cannot draw into the window")?;
        let formats = surface.get_capabilities(&adapter).formats;
        if let Some(plain) = formats.iter().find(|f| !f.is_srgb()) {
            configuration.format = *plain;
        }
        surface.configure(&gpu.device, &configuration);
        app.adapter.clone_from(&gpu.adapter_name);
        if gpu.is_software {
            app.toasts.note(format!("No graphics card was found: {} draws, slowly.", gpu.adapter_name));
        }
        let composer = FrameComposer::new(&gpu, configuration.format, appearance);
        let egui = egui_winit::State::new(
            composer.context().clone(),
            egui::ViewportId::ROOT,
            &window,
            Some(window.scale_factor() as f32),
            None,
            Some(gpu.device.limits().max_texture_dimension_2d as usize),
        );
        let now = Instant::now();
        Ok(Self { window, surface, configuration, gpu, composer, egui, last: now, traced: now })
    }

    /// Ends recordings and gives surface and device up; returns what outlives them, and what became of
    /// the recordings.
    fn close(self) -> (Arc<Window>, Appearance, Result<(), RecorderError>) {
        let appearance = self.composer.appearance().clone();
        let films = self.composer.finish();
        (self.window, appearance, films)
    }

    fn resize(&mut self, size: [u32; 2]) {
        if size.contains(&0) {
            return;
        }
        [self.configuration.width, self.configuration.height] = drawable(size, &self.gpu);
        self.surface.configure(&self.gpu.device, &self.configuration);
    }

    fn frame(&mut self, app: &mut App, trace: bool) {
        let now = Instant::now();
        let dt = (now - self.last).as_secs_f32();
        self.last = now;
        app.advance(dt);
        if trace && (now - self.traced).as_secs_f32() > 0.25 {
            self.traced = now;
            crate::cli::trace(app);
        }
        let input = self.egui.take_egui_input(&self.window);
        let mut output = self.composer.panels(app, input);
        self.egui.handle_platform_output(&self.window, std::mem::take(&mut output.platform_output));
        let size = [self.configuration.width, self.configuration.height];
        let texture = match self.surface.get_current_texture() {
            wgpu::CurrentSurfaceTexture::Success(texture)
            | wgpu::CurrentSurfaceTexture::Suboptimal(texture) => Some(texture),
            wgpu::CurrentSurfaceTexture::Outdated | wgpu::CurrentSurfaceTexture::Lost => {
                self.surface.configure(&self.gpu.device, &self.configuration);
                None
            }
            // Minimised, covered or late: the simulation runs, there is nothing to draw into.
            _ => None,
        };
        let Some(texture) = texture else {
            self.composer.skip(output);
            // A lost device may say so only when asked; the next event then finds it lost.
            let _ = self.gpu.device.poll(wgpu::PollType::Poll);
            std::thread::sleep(std::time::Duration::from_millis(10));
            return;
        };
        let view = texture.texture.create_view(&wgpu::TextureViewDescriptor::default());
        let start = Instant::now();
        self.composer.draw(app, output, &view, size);
        app.plots.draw.push(start.elapsed().as_secs_f32() * 1e3);
        self.window.pre_present_notify();
        self.gpu.queue.present(texture);
    }
}

/// The size of a picture for a window of `size` pixels: at least one pixel, and no more than the adapter can draw.
fn drawable(size: [u32; 2], gpu: &Gpu) -> [u32; 2] {
    let most = gpu.device.limits().max_texture_dimension_2d;
    size.map(|side| side.clamp(1, most))
}
