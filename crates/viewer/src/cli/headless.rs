//! The demo without a window: a scripted pad, a report, pictures through the same renderer.

use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context as _, bail};
use replay::Replay;

use super::open::open;
use super::pad_input::PadInput;
use super::replay_files;
use super::report::{Compared, RaceReport, Report};
use super::{Demo, MOST_SECS};
use crate::analysis::Analysis;
use crate::app::App;
use crate::files;
use crate::frame_composer::FrameComposer;
use crate::gpu::Gpu;
use crate::recorder;
use crate::render::{Appearance, OffScreen, RenderConfig};
use crate::signals::{self, Signal};
use crate::sim::{Divergence, LIE_SECS, Playback};

/// Runs the demo without a window.
///
/// # Errors
/// When a file can't be read or written, or nothing can be drawn though pictures are asked for.
pub fn run(demo: &Demo) -> anyhow::Result<Report> {
    let (demo, replay) = replay_files::chosen(demo)?;
    let report = Headless::through(&demo, replay.as_ref())?.report();
    if let Some(path) = &demo.report {
        let text = serde_json::to_string_pretty(&report).context("report")? + "\n";
        files::write(path, text.as_bytes()).with_context(|| format!("cannot write {}", path.display()))?;
    }
    Ok(report)
}

/// What a clip shown without a window came to.
#[derive(Clone, Debug, PartialEq)]
pub struct Played {
    /// Name of the clip.
    pub clip: String,
    /// Seconds that were shown.
    pub seconds: f64,
    /// Poses of the clip.
    pub poses: usize,
    /// Poses a second.
    pub hz: f64,
    /// Pictures written.
    pub frames: usize,
}

/// Shows the clip of `--poses` without a window; `None` when there is none.
///
/// # Errors
/// As [`run`].
pub fn play(demo: &Demo) -> anyhow::Result<Option<Played>> {
    let run = Headless::through(demo, None)?;
    Ok(run.app.sim.playback().map(|clip| Played {
        clip: clip.clip().into(),
        seconds: run.seconds,
        poses: clip.pose_count(),
        hz: clip.hz(),
        frames: run.painter.as_ref().map_or(0, |p| p.drawn),
    }))
}

struct Headless<'a> {
    demo: &'a Demo,
    app: App,
    input: PadInput,
    second: Option<PadInput>,
    seconds: f64,
    ended_by: Option<Signal>,
    painter: Option<Painter>,
    divergences: usize,
    replays: Vec<String>,
}

impl<'a> Headless<'a> {
    /// A whole run.
    fn through(demo: &'a Demo, replay: Option<&Replay>) -> anyhow::Result<Self> {
        let mut run = Self::new(demo, replay)?;
        let tick_secs = run.tick_secs();
        let ticks = (run.seconds / tick_secs).round().max(1.0) as u64;
        for tick in 0..ticks {
            run.ended_by = signals::received();
            if run.ended_by.is_some() {
                run.seconds = tick as f64 * tick_secs;
                break;
            }
            run.tick(tick)?;
            if run.app.replay_stopped.is_some() {
                break;
            }
        }
        run.app.toasts.take_text().iter().flat_map(|text| text.lines()).for_each(super::remark);
        replay_files::end(demo, &run.app)?;
        Ok(run)
    }

    fn new(demo: &'a Demo, replay: Option<&Replay>) -> anyhow::Result<Self> {
        let (input, second) = (PadInput::load(demo)?, PadInput::load_second(demo)?);
        let opened = open(demo)?;
        let mut app = opened.app;
        replay_files::begin(demo, replay, &mut app)?;
        let played = replay.map(|replay| f64::from(replay.ticks()) * f64::from(app.sim.tick_secs()));
        let clip = app.sim.playback().map(Playback::duration);
        let seconds = demo.seconds.or(clip).or(played).or(input.duration()).unwrap_or(10.0);
        if seconds > MOST_SECS {
            bail!(
                "expected a script or recording of at most {MOST_SECS} s, found {seconds} s; --seconds plays a part"
            );
        }
        if let Some(complaint) = app.toasts.take_text() {
            bail!("{complaint}");
        }
        if demo.panels.is_some() {
            app.analysis = Analysis::of(app.sim.pack());
        }
        let painter = match &demo.frames {
            Some(folder) => Some(Painter::new(demo, folder, opened.appearance, &mut app)?),
            None => None,
        };
        Ok(Self {
            demo,
            app,
            input,
            second,
            seconds,
            ended_by: None,
            painter,
            divergences: 0,
            replays: Vec::new(),
        })
    }

    fn tick_secs(&self) -> f64 {
        self.app.sim.tick_secs().into()
    }

    fn tick(&mut self, tick: u64) -> anyhow::Result<()> {
        let tick_secs = self.tick_secs();
        let start = tick as f64 * tick_secs;
        let pad = self.input.state_at(start);
        (self.app.pad.raw, self.app.pad.state) = (pad, pad);
        self.app.pad.second = self.second.as_mut().map(|second| second.state_at(start));
        for divergence in self.app.tick() {
            self.keep(&divergence)?;
            self.app.sim.stand_up(divergence.character);
        }
        if self.demo.trace && tick.is_multiple_of(15) {
            super::trace(&self.app);
        }
        let mut last = 0.0;
        if let Some(painter) = &mut self.painter {
            // Pictures that fall into this tick, each between its two ends.
            loop {
                let due = painter.drawn as f64 / f64::from(self.demo.fps);
                let alpha = ((due - start) / tick_secs) as f32;
                if alpha > 1.0 - 1e-4 {
                    break;
                }
                let alpha = alpha.max(0.0);
                self.app.follow((alpha - last) * tick_secs as f32, alpha);
                painter.paint(&mut self.app, alpha)?;
                last = alpha;
            }
        }
        self.app.follow((1.0 - last) * tick_secs as f32, 1.0);
        Ok(())
    }

    /// Saves the state before a divergence beside the report.
    fn keep(&mut self, divergence: &Divergence) -> anyhow::Result<()> {
        self.divergences += 1;
        // Ten tell the story; a run that diverges every tick must not fill the disk.
        if self.replays.len() < 10
            && let (Some(report), Some(replay)) = (&self.demo.report, &divergence.replay)
        {
            let path = report.with_extension(format!("diverged{}.json", self.replays.len()));
            replay.save(&path).with_context(|| format!("replay file of {}", divergence.what))?;
            self.replays.push(path.display().to_string());
        }
        Ok(())
    }

    fn report(self) -> Report {
        let totals = self.app.sim.totals();
        let characters = self.app.sim.characters().len();
        // A run that a signal ended before its first tick has nothing to divide by.
        let ticks = (totals.character_ticks as f64).max(1.0);
        let distance_m = totals.distance_m / characters as f64;
        let after_a_fall = match self.app.sim.pack().recovery() {
            Some(skill) => {
                format!("the skill {} is started", self.app.sim.pack().skills()[skill.index()].name)
            }
            None => format!("no skill to get up in the pack: stood up after {LIE_SECS} s"),
        };
        Report {
            seconds: self.seconds,
            ended_by: self.ended_by.map(|signal| signal.name),
            scene: self.app.sim.config().scene.name(),
            characters,
            physics: self.demo.physics.name(),
            mode: self.demo.mode.name(),
            terrain: self.demo.terrain.name(),
            seed: self.demo.seed,
            upright_fraction: 1.0 - totals.down_ticks as f64 / ticks,
            distance_m,
            falls: totals.falls,
            after_a_fall,
            stood_up: totals.stood_up,
            diverged: self.divergences + self.app.put_right,
            replays: self.replays,
            mean_speed_mps: distance_m / self.seconds.max(self.app.sim.tick_secs().into()),
            control_ticks_per_second: ticks / totals.whole.as_secs_f64().max(1e-9),
            policy_microseconds_per_tick: totals.policy.as_secs_f64() * 1e6 / ticks,
            comparison: Compared::of(&self.app.sim),
            race: self.app.sim.shared().map(|s| RaceReport::of(s, self.app.sim.tick_secs())),
            state_hash: totals.hash.to_string(),
            frames: self.painter.as_ref().map_or(0, |p| p.drawn),
            adapter: self.painter.as_ref().map(|_| self.app.adapter.clone()),
        }
    }
}

/// Draws pictures into a folder.
struct Painter {
    composer: FrameComposer,
    size: [u32; 2],
    panels: bool,
    fps: u32,
    folder: PathBuf,
    drawn: usize,
}

impl Painter {
    fn new(demo: &Demo, folder: &Path, appearance: Appearance, app: &mut App) -> anyhow::Result<Self> {
        std::fs::create_dir_all(folder)
            .with_context(|| format!("cannot make the folder {}", folder.display()))?;
        let gpu = Gpu::off_screen()?;
        app.adapter.clone_from(&gpu.adapter_name);
        app.camera.around = demo.view_angle.to_radians();
        // Time does not matter here: full quality, whatever draws.
        let config = RenderConfig { shadow_size: 2048, shadow_taps: 16, ..RenderConfig::default() };
        Ok(Self {
            composer: FrameComposer::with_config(&gpu, OffScreen::FORMAT, config, appearance),
            size: demo.size,
            panels: demo.panels.is_some(),
            fps: demo.fps,
            folder: folder.to_owned(),
            drawn: 0,
        })
    }

    /// Draws the world `alpha` of the way into its last tick.
    fn paint(&mut self, app: &mut App, alpha: f32) -> anyhow::Result<()> {
        app.clock.set_alpha(alpha);
        let start = Instant::now();
        let [width, height] = self.size.map(|s| s as f32);
        let input = egui::RawInput {
            screen_rect: Some(egui::Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(width, height))),
            time: Some(self.drawn as f64 / f64::from(self.fps)),
            ..Default::default()
        };
        let output = self.composer.panels(app, input);
        let picture = self.composer.picture(app, output, self.size, self.panels)?;
        app.plots.draw.push(start.elapsed().as_secs_f32() * 1e3);
        let path = self.folder.join(format!("frame_{:05}.png", self.drawn));
        recorder::save(&picture, &path)?;
        self.drawn += 1;
        Ok(())
    }
}
