//! The demo without a window: a scripted pad, a report, pictures through the same renderer.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use gamepad::Script;
use policy_core::{Body, GamepadState};

use super::report::Report;
use super::{Demo, load};
use crate::assets;
use crate::camera::Camera;
use crate::gpu::Gpu;
use crate::mesh::SkinnedMesh;
use crate::render::{OffScreen, RenderConfig, Renderer, Scene};
use crate::sim::{Blowup, LIE_SECS, SimConfig, Simulation, TICK_SECS};
use crate::stage::{Shown, Trail, ground_grid, set_scene};

/// Runs the demo without a window.
///
/// # Errors
/// When a file can't be read or written, or nothing can be drawn though pictures are asked for.
pub fn run(demo: &Demo) -> anyhow::Result<Report> {
    let mut run = Headless::new(demo)?;
    let ticks = (run.seconds / f64::from(TICK_SECS)).round().max(1.0) as u64;
    for tick in 0..ticks {
        run.tick(tick)?;
    }
    let report = run.report();
    if let Some(path) = &demo.report {
        let text = serde_json::to_string_pretty(&report).context("report")? + "\n";
        write(path, text.as_bytes())?;
    }
    Ok(report)
}

struct Headless<'a> {
    demo: &'a Demo,
    sim: Simulation,
    script: Option<Script>,
    seconds: f64,
    camera: Camera,
    trail: Trail,
    painter: Option<Painter>,
    blowups: usize,
    dumps: Vec<String>,
}

impl<'a> Headless<'a> {
    fn new(demo: &'a Demo) -> anyhow::Result<Self> {
        let script = demo.script.as_deref().map(Script::load).transpose()?;
        let seconds = demo.seconds.or(script.as_ref().map(Script::duration)).unwrap_or(10.0);
        let pack = load::pack(demo.pack.as_deref())?;
        let config =
            SimConfig { ground: demo.terrain, characters: demo.characters, seed: demo.seed, history: false };
        let mut sim = Simulation::new(assets::HUMANOID_MJCF, pack, config)?;
        sim.overrides.mode = demo.mode;
        if let Some(mode) = demo.ghost {
            sim.start_ghost(mode);
        }
        let mut camera = Camera::default();
        camera.distance = demo.distance.unwrap_or(camera.distance);
        let player = sim.player();
        camera.settle(player.state.body(Body::Pelvis).position, player.state.ground_height);
        let painter = match &demo.frames {
            Some(folder) => Some(Painter::new(demo, folder, &sim)?),
            None => None,
        };
        let trail = Trail::default();
        Ok(Self { demo, sim, script, seconds, camera, trail, painter, blowups: 0, dumps: Vec::new() })
    }

    fn tick(&mut self, tick: u64) -> anyhow::Result<()> {
        let start = tick as f64 * f64::from(TICK_SECS);
        let pad = self.script.as_ref().map_or_else(GamepadState::default, |s| s.state_at(start));
        for blowup in self.sim.tick(&pad, self.camera.heading()) {
            self.keep(&blowup)?;
        }
        self.trail.follow(&self.sim);
        if self.demo.trace && tick % 15 == 0 {
            self.trace(start)?;
        }
        let fps = f64::from(self.demo.fps);
        let Some(painter) = &mut self.painter else {
            return Ok(());
        };
        let mut last = 0.0;
        // Pictures that fall into this tick, each between its two ends.
        loop {
            let due = painter.drawn as f64 / fps;
            let alpha = ((due - start) / f64::from(TICK_SECS)) as f32;
            if alpha > 1.0 - 1e-4 {
                break;
            }
            let alpha = alpha.max(0.0);
            let player = self.sim.player();
            let pelvis = player.poses(alpha).positions[0];
            let dt = (alpha - last) * TICK_SECS;
            self.camera.advance(dt, pad.right_stick, pelvis, player.heading(), player.state.ground_height);
            painter.paint(&self.sim, &self.camera, alpha, &self.trail, &pad)?;
            last = alpha;
        }
        let player = self.sim.player();
        let pelvis = player.state.body(Body::Pelvis).position;
        let dt = (1.0 - last) * TICK_SECS;
        self.camera.advance(dt, pad.right_stick, pelvis, player.heading(), player.state.ground_height);
        Ok(())
    }

    /// Saves the state before a divergence beside the report.
    fn keep(&mut self, blowup: &Blowup) -> anyhow::Result<()> {
        self.blowups += 1;
        // Ten tell the story; a run that diverges every tick must not fill the disk.
        if self.dumps.len() < 10
            && let Some(report) = &self.demo.report
        {
            let path = report.with_extension(format!("diverged{}.json", self.dumps.len()));
            blowup.dump.save(&path).with_context(|| format!("dump of {}", blowup.what))?;
            self.dumps.push(path.display().to_string());
        }
        Ok(())
    }

    fn trace(&self, time: f64) -> anyhow::Result<()> {
        let player = self.sim.player();
        let report = player.report();
        let nodes = self.sim.pack().graph().nodes();
        let at = player.state.body(Body::Pelvis).position;
        writeln!(
            std::io::stderr(),
            "{time:6.2} s  {} -> {} {:.2}  at {:6.2} {:6.2} {:5.2}  {:.2} m/s{}{}",
            nodes[report.position.from].name,
            nodes[report.position.to].name,
            report.position.t,
            at.x,
            at.y,
            at.z,
            player.speed(),
            report.skill.map_or(String::new(), |s| format!("  {}", self.sim.pack().skills()[s.skill].name)),
            if player.is_down() { "  down" } else { "" },
        )?;
        Ok(())
    }

    fn report(self) -> Report {
        let totals = self.sim.totals();
        let characters = self.sim.actors().len();
        let ticks = totals.character_ticks as f64;
        let distance_m = totals.distance_m / characters as f64;
        let after_a_fall = match self.sim.pack().recovery() {
            Some(skill) => format!("the skill {} is started", self.sim.pack().skills()[skill].name),
            None => format!("no skill to rise in the pack: stood up after {LIE_SECS} s"),
        };
        Report {
            seconds: self.seconds,
            characters,
            mode: self.demo.mode.name(),
            terrain: self.demo.terrain.name(),
            seed: self.demo.seed,
            upright_fraction: 1.0 - totals.down_ticks as f64 / ticks,
            distance_m,
            falls: totals.falls,
            after_a_fall,
            stood_up: totals.stood_up,
            diverged: self.blowups,
            dumps: self.dumps,
            mean_speed_mps: distance_m / self.seconds,
            control_ticks_per_second: ticks / totals.whole.as_secs_f64().max(1e-9),
            policy_microseconds_per_tick: totals.policy.as_secs_f64() * 1e6 / ticks,
            state_hash: totals.hash.to_string(),
            frames: self.painter.as_ref().map_or(0, |p| p.drawn),
            adapter: self.painter.map(|p| p.gpu.adapter_name),
        }
    }
}

/// Draws pictures into a folder.
struct Painter {
    gpu: Gpu,
    renderer: Renderer,
    target: OffScreen,
    scene: Scene,
    shown: Shown,
    around: f32,
    folder: PathBuf,
    drawn: usize,
}

impl Painter {
    fn new(demo: &Demo, folder: &Path, sim: &Simulation) -> anyhow::Result<Self> {
        std::fs::create_dir_all(folder)
            .with_context(|| format!("cannot make the folder {}", folder.display()))?;
        let gpu = Gpu::off_screen()?;
        let mesh: SkinnedMesh = match load::mesh(demo.mesh.as_deref())? {
            (mesh, None) => mesh,
            (_, Some(complaint)) => bail!("{complaint}"),
        };
        let config = RenderConfig { shadow_taps: 16, ..RenderConfig::for_adapter(gpu.is_software) };
        let mut renderer = Renderer::new(&gpu, OffScreen::FORMAT, config, mesh);
        let outside = sim.model().height_at(1e4, 1e4);
        renderer.set_ground(ground_grid(sim.model().height_field(), outside).as_ref());
        Ok(Self {
            target: OffScreen::new(&gpu, demo.size),
            gpu,
            renderer,
            scene: Scene::default(),
            shown: Shown::default(),
            around: demo.view_angle.to_radians(),
            folder: folder.to_owned(),
            drawn: 0,
        })
    }

    fn paint(
        &mut self,
        sim: &Simulation,
        camera: &Camera,
        alpha: f32,
        trail: &Trail,
        _pad: &GamepadState,
    ) -> anyhow::Result<()> {
        set_scene(&mut self.scene, sim, camera, self.around, (alpha, &self.shown, trail));
        let picture = self.renderer.picture(&self.target, &self.scene)?;
        let path = self.folder.join(format!("frame_{:05}.png", self.drawn));
        picture.save(&path).with_context(|| format!("cannot write {}", path.display()))?;
        self.drawn += 1;
        Ok(())
    }
}

fn write(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    if let Some(folder) = path.parent().filter(|p| !p.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder)
            .with_context(|| format!("cannot make the folder {}", folder.display()))?;
    }
    std::fs::write(path, bytes).with_context(|| format!("cannot write {}", path.display()))
}
