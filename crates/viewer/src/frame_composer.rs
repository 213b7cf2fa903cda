//! Composes a frame: panels, picture, overlay, recording. The same for a window and off screen.

use std::path::{Path, PathBuf};
use std::time::{Instant, SystemTime};

use image::RgbaImage;

use crate::app::{App, Quality, Record};
use crate::dropped::word_about;
use crate::gpu::{Gpu, GpuError};
use crate::overlay::{Overlay, Prepared};
use crate::recorder::{self, Kind, Recorder, RecorderError};
use crate::render::{Appearance, OffScreen, Part, RenderConfig, Renderer, Scene};
use crate::scene_setup::ground_grid;

/// Folder of recordings, in the present one.
const FOLDER: &str = "policy-space-recordings";
/// Pictures a second that films say they have.
const FILM_FPS: u32 = 30;

/// Renderer, overlay and recorder around an [`App`].
pub struct FrameComposer {
    gpu: Gpu,
    format: wgpu::TextureFormat,
    renderer: Renderer,
    quality: Quality,
    overlay: Overlay,
    context: egui::Context,
    scene: Scene,
    recorder: Option<(Recorder, Instant, usize)>,
    /// Recordings that are still being written.
    closing: Vec<Recorder>,
}

impl std::fmt::Debug for FrameComposer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("FrameComposer").field("format", &self.format).finish_non_exhaustive()
    }
}

impl FrameComposer {
    /// For views of `format`.
    #[must_use]
    pub fn new(gpu: &Gpu, format: wgpu::TextureFormat, appearance: Appearance) -> Self {
        Self::with_config(gpu, format, RenderConfig::for_adapter(gpu.is_software), appearance)
    }

    /// The same with a quality other than what the adapter can show in time.
    #[must_use]
    pub fn with_config(
        gpu: &Gpu,
        format: wgpu::TextureFormat,
        config: RenderConfig,
        appearance: Appearance,
    ) -> Self {
        let context = egui::Context::default();
        context.set_theme(egui::Theme::Dark);
        Self {
            gpu: gpu.clone(),
            format,
            renderer: Renderer::new(gpu, format, config, appearance),
            quality: Quality::default(),
            overlay: Overlay::new(gpu, format),
            context,
            scene: Scene::default(),
            recorder: None,
            closing: Vec::new(),
        }
    }

    /// Of the panels.
    #[must_use]
    pub fn context(&self) -> &egui::Context {
        &self.context
    }

    /// Runs the panels over `input`.
    pub fn panels(&mut self, app: &mut App, input: egui::RawInput) -> egui::FullOutput {
        let start = Instant::now();
        let output = self.context.run_ui(input, |ui| app.ui(ui));
        app.plots.ui.push(start.elapsed().as_secs_f32() * 1e3);
        for path in std::mem::take(&mut app.dropped) {
            self.open_dropped(app, &path);
        }
        output
    }

    /// Opens a file that was dropped on the window, and says what came of it. What can't be opened changes nothing.
    fn open_dropped(&mut self, app: &mut App, path: &Path) {
        let name = path.display();
        match app.open_dropped(path) {
            Ok((what, appearance)) => {
                app.has_mesh = appearance.mesh().is_some();
                self.renderer.set_appearance(appearance);
                let word = word_about(app.sim.pack()).filter(|_| what != "mesh");
                app.toasts.note(format!(
                    "Opened the {what} {name}{}",
                    word.map_or_else(String::new, |word| format!(": {word}"))
                ));
            }
            Err(error) => app.toasts.error(error.to_string()),
        }
    }

    /// Uploads what a frame that is not drawn has changed.
    pub fn skip(&mut self, output: egui::FullOutput) {
        let mut prepared = Prepared::new(&self.context, output);
        self.overlay.upload(&mut prepared);
        self.overlay.free(&mut prepared);
    }

    /// Draws picture and panels into `view` and sends it off; records when that is asked for.
    pub fn draw(
        &mut self,
        app: &mut App,
        output: egui::FullOutput,
        view: &wgpu::TextureView,
        size: [u32; 2],
    ) {
        let mut prepared = self.prepare(app, output);
        self.paint(app, view, size);
        let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        self.overlay.draw(&mut encoder, view, size, &prepared);
        self.gpu.queue.submit([encoder.finish()]);
        // A lost device often shows here: it takes no more pictures.
        if self.gpu.lost().is_none() {
            self.record(app, size, &prepared);
        }
        self.overlay.free(&mut prepared);
    }

    /// Draws picture and, with `panels`, their overlay off screen and reads it back.
    ///
    /// # Errors
    /// When the device is lost.
    pub fn picture(
        &mut self,
        app: &mut App,
        mut output: egui::FullOutput,
        size: [u32; 2],
        panels: bool,
    ) -> Result<RgbaImage, GpuError> {
        if self.gpu.lost().is_some() {
            output.textures_delta.clear();
            return Err(GpuError::Lost);
        }
        let mut prepared = self.prepare(app, output);
        let picture = self.capture(app, size, panels.then_some(&prepared));
        self.overlay.free(&mut prepared);
        picture
    }

    fn prepare(&mut self, app: &mut App, output: egui::FullOutput) -> Prepared {
        let quality = app.layout.preferences.quality;
        if quality != self.quality {
            let config = quality.render_config(self.gpu.is_software);
            let appearance = self.renderer.appearance().clone();
            self.renderer = Renderer::new(&self.gpu, self.format, config, appearance);
            (self.quality, app.ground_changed) = (quality, true);
        }
        if app.ground_changed {
            let model = app.sim.model();
            let grid = ground_grid(model.height_field(), model.height_at(1e4, 1e4));
            self.renderer.set_ground(grid.as_ref());
            app.ground_changed = false;
        }
        let mut prepared = Prepared::new(&self.context, output);
        self.overlay.upload(&mut prepared);
        prepared
    }

    /// Draws the picture of every view into its part of `view` and sends them off.
    fn paint(&mut self, app: &App, view: &wgpu::TextureView, size: [u32; 2]) {
        let scale = self.context.pixels_per_point();
        let screen =
            egui::Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(size[0] as f32, size[1] as f32) / scale);
        let views = app.views();
        for index in 0..views {
            app.set_scene(&mut self.scene, index);
            let part = app.part(index, screen);
            let [left, right] =
                [part.left(), part.right()].map(|x| ((x * scale).round() as u32).min(size[0]));
            let part = if views == 1 {
                Part::whole(size)
            } else {
                Part { left, width: right - left, first: index == 0, last: index + 1 == views }
            };
            let mut encoder =
                self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            self.renderer.draw_part(&mut encoder, view, (size, part), &self.scene);
            self.gpu.queue.submit([encoder.finish()]);
        }
    }

    fn capture(
        &mut self,
        app: &App,
        size: [u32; 2],
        prepared: Option<&Prepared>,
    ) -> Result<RgbaImage, GpuError> {
        let target = OffScreen::with_format(&self.gpu, size, self.format);
        self.paint(app, target.view(), size);
        let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        if let Some(prepared) = prepared {
            self.overlay.draw(&mut encoder, target.view(), size, prepared);
        }
        target.finish(&self.gpu, encoder)
    }

    /// Starts, feeds or ends what the user asked to be recorded.
    fn record(&mut self, app: &mut App, size: [u32; 2], prepared: &Prepared) {
        self.report_written(app);
        match app.record.take() {
            Some(Record::Screenshot) => {
                let path = name("png");
                let saved = self.capture(app, size, Some(prepared)).map_err(|e| e.to_string());
                let saved = saved.and_then(|p| recorder::save(&p, &path).map_err(|e| e.to_string()));
                match saved {
                    Ok(()) => app.toasts.note(format!("Saved {}", path.display())),
                    Err(error) => app.toasts.error(error),
                }
            }
            Some(Record::Sequence) => self.start(app, Kind::Sequence, size),
            Some(Record::Video) => self.start(app, Kind::film(), size),
            Some(Record::Stop) => self.stop(app),
            None => {}
        }
        let Some((_, start, taken)) = &self.recorder else { return };
        let due = (start.elapsed().as_secs_f32() * FILM_FPS as f32) as usize;
        if due < *taken {
            return;
        }
        let picture = self.capture(app, size, Some(prepared));
        let Some((recorder, _, taken)) = &mut self.recorder else { return };
        *taken = due + 1;
        if !picture.is_ok_and(|p| recorder.take(p, due as u32)) {
            self.stop(app);
        }
    }

    fn start(&mut self, app: &mut App, kind: Kind, size: [u32; 2]) {
        self.stop(app);
        let path = name(kind.extension());
        app.recording = Some(path.display().to_string());
        self.recorder = Some((Recorder::start(kind, path, size, FILM_FPS), Instant::now(), 0));
    }

    /// Ends the recording; what is left is written while the demo runs.
    fn stop(&mut self, app: &mut App) {
        app.recording = None;
        if let Some((mut recorder, ..)) = self.recorder.take() {
            recorder.close();
            self.closing.push(recorder);
        }
    }

    /// Says which recordings have been written.
    fn report_written(&mut self, app: &mut App) {
        for recorder in self.closing.extract_if(.., |recorder| recorder.is_finished()) {
            let path = recorder.path().display().to_string();
            match recorder.finish() {
                Ok(0) => app.toasts.note(format!("Saved {path}")),
                Ok(dropped) => app.toasts.error(format!(
                    "Saved {path}; {} dropped because the disk was too slow.",
                    if dropped == 1 {
                        "1 picture was".to_owned()
                    } else {
                        format!("{dropped} pictures were")
                    }
                )),
                Err(error) => app.toasts.error(error.to_string()),
            }
        }
    }

    /// How characters are drawn.
    #[must_use]
    pub fn appearance(&self) -> &Appearance {
        self.renderer.appearance()
    }

    /// Ends recordings that still run, and waits until they are written.
    ///
    /// # Errors
    /// The first of those that could not be written; the others are written all the same.
    pub fn finish(self) -> Result<(), RecorderError> {
        let open = self.recorder.map(|(recorder, ..)| recorder).into_iter();
        let finished: Vec<_> = open.chain(self.closing).map(Recorder::finish).collect();
        finished.into_iter().find_map(Result::err).map_or(Ok(()), Err)
    }
}

fn name(extension: &str) -> PathBuf {
    let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    PathBuf::from(FOLDER).join(format!("policy-space-{}.{extension}", since.as_millis()))
}
