//! Benchmarks of whole frames and whole crowds.

use std::sync::Arc;
use std::time::{Duration, Instant};

use anyhow::Context as _;
use glam::Vec2;
use physics_bridge::{Character, Crowd};
use policy_core::{Arithmetic, Command, Controller, ControllerConfig, Goal, Heading, JointTargets};
use serde_json::json;

use super::{Bench, load};
use crate::camera::Camera;
use crate::gpu::Gpu;
use crate::render::{OffScreen, RenderConfig, Renderer, Scene};
use crate::scene_setup::{Picture, Shown, Trail, set_scene};
use crate::sim::{SimConfig, Simulation, model_of};
use crate::text::counted;

/// Characters in the crowd that is timed.
const CROWD: usize = 64;
/// Rounds; each runs both loops, so that both see the same machine.
const ROUNDS: usize = 60;
/// Control ticks a round.
const TICKS: usize = 5;

/// Characters that run in real time with controllers, and without: the fastest round of each, as text.
///
/// # Errors
/// When the pack or its body is broken.
pub fn crowd(bench: Bench) -> anyhow::Result<String> {
    let pack = load::pack(None)?;
    let model = model_of(&pack)?;
    let walk = pack.graph().node_named("walk").context("the pack has no policy called walk")?;
    let stand = |index: usize| -> anyhow::Result<Character> {
        let mut character = Character::new(&model);
        let heading = Heading::from_angle(index as f32);
        character.stand_at(3.0 * index as f32, 0.0, heading, physics_bridge::WALKING_START_MPS)?;
        Ok(character)
    };
    let characters = (0..CROWD).map(stand).collect::<anyhow::Result<Vec<_>>>()?;
    let mut crowd = Crowd::new(characters, None)?;
    let config =
        ControllerConfig { arithmetic: Arithmetic::Fused, start: walk, ..ControllerConfig::default() };
    let mut controllers = vec![Controller::with_config(Arc::clone(&pack), config); CROWD];
    let command = |index: usize| Command {
        target: Some(Vec2::new(3.0 * index as f32, 0.0) + Vec2::from_angle(index as f32) * 1000.0),
        goal: Goal::Node(walk),
        ..Command::default()
    };
    let commands: Vec<Command> = (0..CROWD).map(command).collect();
    let tick_secs = 1.0 / model.control_hz();
    let mut targets = vec![JointTargets::new(model.skeleton()); CROWD];
    let (mut best_full, mut best_bare, mut share) = (f64::INFINITY, f64::INFINITY, 1.0);
    for _ in 0..ROUNDS {
        let mut policy = Duration::ZERO;
        let start = Instant::now();
        for _ in 0..TICKS {
            crowd.control_tick(&mut controllers, &commands, tick_secs);
            policy += crowd.control_time();
        }
        let full = start.elapsed().as_secs_f64();
        if full < best_full {
            (best_full, share) = (full, policy.as_secs_f64() / (full * crowd.threads() as f64));
        }
        // The same walk again without controllers: from the same states, held by the same targets.
        let snapshots: Vec<_> = crowd.characters().map(Character::save).collect();
        for (target, controller) in targets.iter_mut().zip(&controllers) {
            target.copy_from_slice(controller.joint_targets());
        }
        let start = Instant::now();
        for _ in 0..TICKS {
            crowd.step(&targets);
        }
        best_bare = best_bare.min(start.elapsed().as_secs_f64());
        for (character, snapshot) in crowd.characters_mut().zip(&snapshots) {
            character.restore(snapshot)?;
        }
    }
    let realtime = |secs: f64| (CROWD * TICKS) as f64 / secs / f64::from(model.control_hz());
    let (full, bare) = (realtime(best_full), realtime(best_bare));
    if bench.json {
        let object =
            json!({ "characters_realtime": full, "bare_mujoco_characters": bare, "policy_share": share });
        return Ok(object.to_string());
    }
    Ok(format!(
        "characters in real time, {:.0} Hz control, {:.0} Hz physics, {}
  with controllers     {full:8.0}
  stepping alone       {bare:8.0}   ({:.1} %)
  share of the policy  {:8.2} %",
        model.control_hz(),
        1.0 / model.timestep_secs(),
        counted(crowd.threads() as u64, "thread"),
        100.0 * full / bare,
        100.0 * share,
    ))
}

/// Pictures a second off screen at 1280x720, as text.
///
/// # Errors
/// When there is nothing to draw with.
pub fn frame(bench: Bench) -> anyhow::Result<String> {
    let gpu = Gpu::off_screen()?;
    let one = frames_per_second(&gpu, 1)?;
    let hundred = frames_per_second(&gpu, 100)?;
    if bench.json {
        return Ok(json!({ "fps_1": one, "fps_100": hundred, "adapter": gpu.adapter_name }).to_string());
    }
    Ok(format!(
        "pictures a second at 1280x720, 4x MSAA, drawn by {}
  1 character     {one:8.1}
  100 characters  {hundred:8.1}",
        gpu.adapter_name,
    ))
}

fn frames_per_second(gpu: &Gpu, characters: usize) -> anyhow::Result<f64> {
    let config = SimConfig { characters, ..SimConfig::default() };
    let mut sim = Simulation::new(load::pack(None)?, config)?;
    let (appearance, _) = load::appearance(None, sim.pack(), sim.model());
    let config = RenderConfig::for_adapter(gpu.is_software);
    let mut renderer = Renderer::new(gpu, OffScreen::FORMAT, config, appearance);
    let target = OffScreen::new(gpu, [1280, 720]);
    let mut camera = Camera::default();
    camera.around = 0.6;
    if characters > 1 {
        (camera.distance, camera.pitch) = (14.0, 0.4);
    }
    camera.settle(sim.player().poses(1.0).positions[0], 0.0);
    let mut scene = Scene::default();
    let mut draw = |sim: &Simulation, alpha: f32| -> anyhow::Result<f64> {
        let start = Instant::now();
        let picture = Picture {
            view: camera.view(),
            alone: None,
            alpha,
            shown: &Shown::default(),
            trail: &Trail::default(),
        };
        set_scene(&mut scene, sim, &picture);
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        renderer.draw(&mut encoder, target.view(), target.size(), &scene);
        gpu.queue.submit([encoder.finish()]);
        gpu.device.poll(wgpu::PollType::wait_indefinitely())?;
        Ok(start.elapsed().as_secs_f64())
    };
    for warm in 0..3 {
        draw(&sim, warm as f32 / 3.0)?;
    }
    let mut times = Vec::new();
    for tick in 0..30 {
        sim.tick(&policy_core::GamepadState::default(), Heading::FORWARD);
        times.push(draw(&sim, (tick % 3) as f32 / 3.0)?);
    }
    times.sort_by(f64::total_cmp);
    Ok(1.0 / times[times.len() / 2])
}
