//! Draws the mannequin in its rest pose: the renderer needs a mesh, a scene and nothing else.

use glam::{Quat, Vec3};
use viewer::render::{Figure, OffScreen, RenderConfig, Renderer, Scene, View};
use viewer::{gpu::Gpu, mannequin, mesh::SkinnedMesh};

fn main() -> anyhow::Result<()> {
    let path = std::env::args().nth(1).unwrap_or_else(|| "still.png".into());
    let gpu = Gpu::off_screen()?;
    let mesh = SkinnedMesh::from_bytes(&mannequin::generate())?;
    let config = RenderConfig::for_adapter(gpu.is_software);
    let mut renderer = Renderer::new(&gpu, OffScreen::FORMAT, config, mesh);
    let positions = mannequin::rest_positions().map(|p| p + Vec3::Z * 0.881);
    let figure =
        Figure { positions, rotations: [Quat::IDENTITY; 15], tint: [0.0; 4], ground: 0.0, slope: [0.0; 2] };
    let view = View { eye: Vec3::new(2.3, 1.2, 1.35), target: Vec3::new(0.0, 0.0, 0.83), fov: 0.62 };
    let scene = Scene { view, figures: vec![figure], ..Scene::default() };
    let target = OffScreen::new(&gpu, [1280, 720]);
    renderer.picture(&target, &scene)?.save(&path)?;
    println!("{path}, drawn by {}", gpu.adapter_name);
    Ok(())
}
