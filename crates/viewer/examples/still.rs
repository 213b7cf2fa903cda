//! Draws the mannequin in its rest pose: the renderer needs a mesh, a scene and nothing else.

use glam::{Quat, Vec3};
use policy_core::Skeleton;
use viewer::mesh::{Rig, SkinnedMesh};
use viewer::render::{Appearance, Figure, OffScreen, RenderConfig, Renderer, Scene, View};
use viewer::{gpu::Gpu, mannequin};

fn main() -> anyhow::Result<()> {
    let path = std::env::args().nth(1).unwrap_or_else(|| "still.png".into());
    let gpu = Gpu::off_screen()?;
    let skeleton = Skeleton::humanoid();
    let rig = Rig::new(skeleton.clone().into(), mannequin::rest_positions().to_vec());
    let mesh = SkinnedMesh::from_bytes(&mannequin::generate(), &rig)?;
    let config = RenderConfig::for_adapter(gpu.is_software);
    let mut renderer = Renderer::new(&gpu, OffScreen::FORMAT, config, Appearance::new(&skeleton, Some(mesh)));
    let positions: Vec<Vec3> = mannequin::rest_positions().iter().map(|p| p + Vec3::Z * 0.881).collect();
    let rotations = vec![Quat::IDENTITY; positions.len()];
    let figure = Figure { positions, rotations, tint: [0.0; 4], ground: 0.0, slope: [0.0; 2] };
    let view = View { eye: Vec3::new(2.3, 1.2, 1.35), target: Vec3::new(0.0, 0.0, 0.83), fov: 0.62 };
    let scene = Scene { view, figures: vec![figure], ..Scene::default() };
    let target = OffScreen::new(&gpu, [1280, 720]);
    renderer.picture(&target, &scene)?.save(&path)?;
    println!("{path}, drawn by {}", gpu.adapter_name);
    Ok(())
}
