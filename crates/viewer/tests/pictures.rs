//! Shaders, and pictures against committed ones with a tolerance. Skipped with a message without an adapter.

mod common;

use common::{gpu, simulation};
use egui_kittest::{SnapshotOptions, try_image_snapshot_options};
use image::RgbaImage;
use viewer::app::{App, PanelKind, PanelLayout, Quality, Side};
use viewer::frame_composer::FrameComposer;
use viewer::render::{Appearance, OffScreen, RenderConfig, Renderer, SHADERS, Scene};
use viewer::scene_setup::{Picture, Shown, Trail, ground_grid, set_scene};
use viewer::sim::{GroundKind, SimConfig};

const SIZE: [u32; 2] = [320, 240];

/// Of the scene's pixels one in so many may differ; edges of shadows are rounded here or there.
const SCENE: usize = 50;
/// Of pictures with panels; a letter is about thirty pixels.
const PANELS: usize = 2000;

fn appearance(app: &App) -> Appearance {
    viewer::appearance::of_pack(app.sim.pack(), app.sim.model()).0
}

/// Compares where the same software renderer drew the committed picture; other adapters round otherwise.
/// One pixel in `tolerance` may differ.
fn compare(gpu: &viewer::gpu::Gpu, picture: &RgbaImage, name: &str, tolerance: usize) {
    if !gpu.is_software {
        eprintln!("skipped the comparison of {name}: drawn by {}", gpu.adapter_name);
        return;
    }
    let pixels = picture.width() as usize * picture.height() as usize;
    let options = SnapshotOptions::new().threshold(2.0).max_failed_pixels(pixels / tolerance);
    try_image_snapshot_options(picture, name, &options).unwrap();
}

#[test]
fn every_shader_passes_naga() {
    for (name, source) in SHADERS {
        let module = naga::front::wgsl::parse_str(source)
            .unwrap_or_else(|e| panic!("{name}: {}", e.emit_to_string(source)));
        let mut validator = naga::valid::Validator::new(
            naga::valid::ValidationFlags::all(),
            naga::valid::Capabilities::default(),
        );
        validator.validate(&module).unwrap_or_else(|e| panic!("{name}: {e:?}"));
    }
}

/// A picture from aside, of the last tick.
fn shot<'a>(app: &App, shown: &'a Shown, trail: &'a Trail) -> Picture<'a> {
    let mut camera = app.camera;
    camera.around = 0.7;
    Picture { view: camera.view(), alone: None, alpha: 1.0, shown, trail }
}

fn draw(gpu: &viewer::gpu::Gpu, app: &App, shown: &Shown) -> RgbaImage {
    let mut renderer =
        Renderer::new(gpu, OffScreen::FORMAT, RenderConfig::for_adapter(true), appearance(app));
    let model = app.sim.model();
    renderer.set_ground(ground_grid(model.height_field(), model.height_at(1e4, 1e4)).as_ref());
    let mut scene = Scene::default();
    set_scene(&mut scene, &app.sim, &shot(app, shown, &Trail::default()));
    renderer.picture(&OffScreen::new(gpu, SIZE), &scene).unwrap()
}

#[test]
fn the_standing_mannequin_looks_as_it_did() {
    let Some(gpu) = gpu() else { return };
    let app = App::new(simulation(), PanelLayout::default());
    let picture = draw(&gpu, &app, &Shown::default());
    // Sky above, mannequin in the middle, ground below: whatever the adapter.
    let [top, middle] = [(10, 5), (SIZE[0] / 2, SIZE[1] / 2)].map(|(x, y)| picture.get_pixel(x, y).0);
    assert!(top[2] > top[0], "sky {top:?}");
    assert_ne!(top, middle);
    compare(&gpu, &picture, "standing", SCENE);
    let shapes =
        Shown { collision_shapes: true, centre_of_mass: true, contact_forces: true, ..Shown::default() };
    let picture = draw(&gpu, &app, &shapes);
    compare(&gpu, &picture, "collision_shapes", SCENE);
}

#[test]
fn hills_and_a_crowd_look_as_they_did() {
    let Some(gpu) = gpu() else { return };
    let mut app = App::new(simulation(), PanelLayout::default());
    app.sim.rebuild(SimConfig { ground: GroundKind::Wavy, characters: 12, ..SimConfig::default() }).unwrap();
    (app.camera.distance, app.camera.pitch) = (9.0, 0.45);
    app.follow(10.0, 1.0);
    compare(&gpu, &draw(&gpu, &app, &Shown::default()), "hills_and_crowd", SCENE);
}

/// Every panel but the profiler, whose numbers are those of the machine.
#[test]
fn panels_over_the_picture_look_as_they_did() {
    use PanelKind::*;
    let Some(gpu) = gpu() else { return };
    let groups: [(&str, &[PanelKind], &[PanelKind]); 4] = [
        ("panels", &[Paths], &[]),
        ("panels_blends", &[Layers, BlendMode], &[Graph]),
        ("panels_world", &[View], &[Physics]),
        ("panels_skills", &[Skills, Record], &[Pad]),
    ];
    for (name, left, right) in groups {
        let on = |side| move |kind: &PanelKind| (*kind, side);
        let open = left.iter().map(on(Side::Left)).chain(right.iter().map(on(Side::Right)));
        let app = App::new(simulation(), common::advanced(open.collect()));
        compare(&gpu, &draw_with_panels(&gpu, app), name, PANELS);
    }
    let app = App::new(simulation(), PanelLayout::default());
    compare(&gpu, &draw_with_panels(&gpu, app), "panels_simple", PANELS);
    let mut app = App::new(simulation(), PanelLayout::default());
    app.choosing = true;
    compare(&gpu, &draw_with_panels(&gpu, app), "panels_settings", PANELS);
    let mut app = App::new(simulation(), common::advanced(vec![(Analysis, Side::Left)]));
    app.analysis = viewer::analysis::Analysis::of(app.sim.pack());
    compare(&gpu, &draw_with_panels(&gpu, app), "panels_analysis", PANELS);
}

/// The second frame of the demo: the first one lays out its widgets.
fn draw_with_panels(gpu: &viewer::gpu::Gpu, mut app: App) -> RgbaImage {
    let mut composer = FrameComposer::new(gpu, OffScreen::FORMAT, appearance(&app));
    app.camera.around = 0.7;
    let mut frame = |time: f64| {
        let rect = egui::Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(640.0, 480.0));
        let input = egui::RawInput { screen_rect: Some(rect), time: Some(time), ..Default::default() };
        let output = composer.panels(&mut app, input);
        composer.picture(&mut app, output, [640, 480], true).unwrap()
    };
    frame(0.0);
    frame(1.0)
}

#[test]
fn the_quality_changes_while_it_runs_and_keeps_the_ground() {
    let Some(gpu) = gpu() else { return };
    let mut app = App::new(simulation(), PanelLayout::default());
    app.sim.rebuild(SimConfig { ground: GroundKind::Wavy, ..SimConfig::default() }).unwrap();
    let mut composer = FrameComposer::new(&gpu, OffScreen::FORMAT, appearance(&app));
    let [before, low, after] = [Quality::Automatic, Quality::Low, Quality::Automatic].map(|quality| {
        app.layout.preferences.quality = quality;
        let output = composer.panels(&mut app, egui::RawInput::default());
        composer.picture(&mut app, output, SIZE, false).unwrap()
    });
    assert!(before == after && before != low);
}

#[test]
fn a_lost_device_is_an_error_and_no_panic() {
    let Some(gpu) = gpu() else { return };
    let mut app = App::new(simulation(), PanelLayout::default());
    let mut composer = FrameComposer::new(&gpu, OffScreen::FORMAT, appearance(&app));
    let mut renderer =
        Renderer::new(&gpu, OffScreen::FORMAT, RenderConfig::for_adapter(true), appearance(&app));
    let mut scene = Scene::default();
    set_scene(&mut scene, &app.sim, &shot(&app, &Shown::default(), &Trail::default()));
    let target = OffScreen::new(&gpu, SIZE);
    assert!(renderer.picture(&target, &scene).is_ok() && gpu.lost().is_none());
    gpu.device.destroy();
    let said = renderer.picture(&target, &scene).unwrap_err().to_string();
    assert!(said.contains("lost"), "{said}");
    assert!(gpu.lost().is_some(), "whoever draws next has to know");
    let output = composer.panels(&mut app, egui::RawInput::default());
    assert!(composer.picture(&mut app, output, SIZE, true).is_err());
}
