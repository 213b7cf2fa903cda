//! What is seen: camera, renderer and the canvas.

use std::sync::Arc;

use physics_rapier::{Character, Model, Pose};
use policy_core::{CharacterState, Heading};
use viewer::camera::Camera;
use viewer::gpu::Gpu;
use viewer::mesh::{Rig, SkinnedMesh};
use viewer::render::{Appearance, Figure, RenderConfig, Renderer, Scene};
use viewer::things;
use wasm_bindgen::prelude::*;

use crate::game::Game;

/// Clothes of the characters.
const TINTS: [[f32; 4]; 4] =
    [[0.0; 4], [0.12, 0.42, 0.78, 0.9], [0.16, 0.55, 0.30, 0.9], [0.75, 0.35, 0.12, 0.9]];

/// The canvas, opened: what takes time and needs no file.
#[wasm_bindgen]
pub struct Screen {
    gpu: Gpu,
    surface: wgpu::Surface<'static>,
    configuration: wgpu::SurfaceConfiguration,
}

#[wasm_bindgen]
impl Screen {
    /// Opens it.
    ///
    /// # Errors
    /// When nothing can be drawn with.
    pub async fn open(canvas: web_sys::HtmlCanvasElement) -> Result<Screen, JsError> {
        let size = [canvas.width().max(1), canvas.height().max(1)];
        let (gpu, surface, adapter) = Gpu::for_target(wgpu::SurfaceTarget::Canvas(canvas)).await?;
        let mut configuration = surface
            .get_default_config(&adapter, size[0], size[1])
            .ok_or_else(|| JsError::new("expected a canvas that the adapter can draw into, found none"))?;
        let formats = surface.get_capabilities(&adapter).formats;
        if let Some(plain) = formats.iter().find(|format| !format.is_srgb()) {
            configuration.format = *plain;
        }
        surface.configure(&gpu.device, &configuration);
        Ok(Self { gpu, surface, configuration })
    }
}

pub struct Stage {
    screen: Screen,
    renderer: Renderer,
    camera: Camera,
    scene: Scene,
}

impl Stage {
    /// Draws the characters of `game`.
    pub fn new(screen: Screen, game: &Game, appearance: Appearance) -> Self {
        let config = quality(screen.gpu.is_software);
        let renderer = Renderer::new(&screen.gpu, screen.configuration.format, config, appearance);
        let mut stage = Self { screen, renderer, camera: Camera::default(), scene: Scene::default() };
        stage.reset(game);
        stage
    }

    pub fn is_software(&self) -> bool {
        self.screen.gpu.is_software
    }

    pub fn lost(&self) -> Option<&str> {
        self.screen.gpu.lost()
    }

    pub fn adapter(&self) -> &str {
        &self.screen.gpu.adapter_name
    }

    pub fn heading(&self) -> Heading {
        self.camera.heading()
    }

    pub fn turn(&mut self, x: f32, y: f32) {
        self.camera.turn(glam::Vec2::new(x, y));
    }

    pub fn zoom(&mut self, factor: f32) {
        self.camera.zoom(factor);
    }

    pub fn resize(&mut self, [width, height]: [u32; 2]) {
        let Screen { gpu, surface, configuration } = &mut self.screen;
        let most = gpu.device.limits().max_texture_dimension_2d;
        let size = [width.clamp(1, most), height.clamp(1, most)];
        if size != [configuration.width, configuration.height] {
            [configuration.width, configuration.height] = size;
            surface.configure(&gpu.device, configuration);
        }
    }

    /// As for a processor that draws, from now on, or as for a graphics card.
    pub fn draw_cheaply(&mut self, on: bool) {
        let appearance = self.renderer.appearance().clone();
        self.renderer =
            Renderer::new(&self.screen.gpu, self.screen.configuration.format, quality(on), appearance);
    }

    /// The camera behind the player again.
    pub fn reset(&mut self, game: &Game) {
        self.camera = Camera::default();
        if let Some(player) = game.arena().player(0) {
            self.camera.set_size(player.state.root_height());
            self.camera.settle(player.state.root().position, player.state.ground_height);
        }
    }

    /// The camera takes `secs` to follow the player.
    pub fn follow(&mut self, secs: f32, stick: [f32; 2], game: &Game) {
        let (Some(player), Some((root, _))) = (game.arena().player(0), game.poses().first().copied()) else {
            return;
        };
        let heading = Heading::from_rotation(player.state.root().rotation);
        self.camera.advance(secs.min(0.1), stick, root, heading, player.state.ground_height);
    }

    /// Draws; false when the canvas gives no picture.
    pub fn draw(&mut self, game: &Game) -> bool {
        self.set_scene(game);
        let Screen { gpu, surface, configuration } = &self.screen;
        let texture = match surface.get_current_texture() {
            wgpu::CurrentSurfaceTexture::Success(texture)
            | wgpu::CurrentSurfaceTexture::Suboptimal(texture) => texture,
            wgpu::CurrentSurfaceTexture::Outdated | wgpu::CurrentSurfaceTexture::Lost => {
                surface.configure(&gpu.device, configuration);
                return false;
            }
            _ => return false,
        };
        let view = texture.texture.create_view(&wgpu::TextureViewDescriptor::default());
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let size = [configuration.width, configuration.height];
        self.renderer.draw(&mut encoder, &view, size, &self.scene);
        gpu.queue.submit([encoder.finish()]);
        gpu.queue.present(texture);
        true
    }

    fn set_scene(&mut self, game: &Game) {
        let scene = &mut self.scene;
        scene.view = self.camera.view();
        scene.focus = scene.view.target.with_z(0.0);
        scene.figures.clear();
        scene.things.clear();
        scene.markers.clear();
        let poses = game.poses();
        let bodies = game.pack().skeleton().body_count();
        let arena = game.arena();
        let (characters, props) = poses.split_at(arena.character_count() * bodies);
        for (index, own) in characters.chunks_exact(bodies).enumerate() {
            scene.figures.push(Figure {
                positions: own.iter().map(|pose| pose.0).collect(),
                rotations: own.iter().map(|pose| pose.1).collect(),
                tint: TINTS[index % TINTS.len()],
                ground: arena.player(index).map_or(0.0, |player| player.state.ground_height),
                slope: [0.0; 2],
            });
        }
        things::fixtures(scene, arena.layout());
        for (&pose, prop) in props.iter().zip(arena.props()) {
            things::prop(scene, prop.solid, pose, prop.paint, prop.anchor);
        }
        if let Some(race) = arena.race(0) {
            things::checkpoints(scene, arena.layout(), race);
        }
    }
}

/// A picture for a graphics card; or for a processor, which draws one sample a pixel and fewer taps of each shadow.
fn quality(cheap: bool) -> RenderConfig {
    let config = RenderConfig::for_adapter(cheap);
    // The coarsest mesh has holes that show near the eye; with fewer pixels a near figure is not many of them.
    let level_pixels = [f32::INFINITY, f32::INFINITY, 150.0];
    if cheap { RenderConfig { samples: 1, shadow_taps: 4, level_pixels, ..config } } else { config }
}

/// How the characters of `game` look with a mesh.
pub fn appearance(game: &Game, mesh: &[u8]) -> Result<Appearance, JsError> {
    let rig = rig(game)?;
    let mesh = SkinnedMesh::from_bytes(mesh, &rig)?;
    Ok(Appearance::new(rig.skeleton(), Some(mesh)))
}

/// The bodies with all joints at zero and the root upright at the origin: what the mesh is bound to.
fn rig(game: &Game) -> Result<Rig, JsError> {
    let model = Model::for_pack(game.pack())?;
    let mut character = Character::new(&model);
    let Pose { qpos, qvel } = Pose::new(model.skeleton());
    character.set_pose(&qpos, &qvel)?;
    let mut state = CharacterState::new(model.skeleton());
    character.sense_into(&mut state);
    let rest = state.bodies.iter().map(|body| body.position).collect();
    Ok(Rig::new(Arc::clone(model.skeleton()), rest))
}
