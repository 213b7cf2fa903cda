//! Characters of other skeletons in the demo: panels, pictures without a mesh, files dropped on the window, runs
//! without a window.

mod common;

use std::process::Command;
use std::sync::Arc;

use common::{gpu, quadruped, simulation, simulation_of};
use egui_kittest::Harness;
use policy_core::{CharacterPack, GamepadState, Heading};
use viewer::app::{App, PanelKind, PanelLayout, Side};
use viewer::assets::{HUMANOID_GLB, HUMANOID_MJCF, HUMANOID_PACK};
use viewer::frame_composer::FrameComposer;
use viewer::mesh::SkinnedMesh;
use viewer::render::{OffScreen, RenderConfig, Renderer, Scene};
use viewer::{appearance, sim};

#[test]
fn a_quadruped_runs_under_every_panel() {
    let open = PanelKind::ALL.map(|kind| (kind, Side::Left)).to_vec();
    let app = App::new(simulation_of(Arc::new(quadruped())), PanelLayout { open, ..PanelLayout::default() });
    let mut harness = Harness::builder()
        .with_size(egui::vec2(1200.0, 3000.0))
        .build_ui_state(|ui, app: &mut App| app.ui(ui), app);
    let bodies = harness.state().sim.player().state.bodies.len();
    assert_ne!(bodies, 15);
    for _ in 0..30 {
        harness.state_mut().pad.state.left_stick = [0.0, 1.0];
        assert!(harness.state_mut().tick().is_empty());
        harness.run_steps(1);
    }
    assert_eq!(harness.state().sim.player().poses(1.0).positions.len(), bodies);
    let position = harness.state().sim.player().report().position;
    assert_eq!(harness.state().sim.pack().graph().node(position.to).name, "trot");
}

#[test]
fn without_a_mesh_its_collision_shapes_are_drawn() {
    let app = App::new(simulation_of(Arc::new(quadruped())), PanelLayout::default());
    let (looks, complaint) = appearance::of_pack(app.sim.pack(), app.sim.model());
    assert!(looks.mesh().is_none() && complaint.is_none(), "the mannequin does not fit it");
    let mut app = app;
    app.has_mesh = false;
    let mut scene = Scene::default();
    app.set_scene(&mut scene, 0);
    assert!(scene.markers.len() >= app.sim.model().shapes().len());
    let Some(gpu) = gpu() else { return };
    let mut renderer = Renderer::new(&gpu, OffScreen::FORMAT, RenderConfig::for_adapter(true), looks);
    let target = OffScreen::new(&gpu, [160, 120]);
    let with = renderer.picture(&target, &scene).unwrap();
    scene.markers.clear();
    let without = renderer.picture(&target, &scene).unwrap();
    let differing = with.pixels().zip(without.pixels()).filter(|(a, b)| a != b).count();
    assert!(differing > 300, "{differing} pixels");
}

/// The humanoid as a pack of version 2: with its body, and with a mesh.
fn humanoid(mesh: Option<&[u8]>) -> CharacterPack {
    let ships = CharacterPack::from_bytes(HUMANOID_PACK).unwrap();
    let (mut manifest, mut tensors) = (ships.manifest().clone(), ships.tensors().clone());
    manifest.mjcf = Some(HUMANOID_MJCF.into());
    tensors.mesh = mesh.map(<[u8]>::to_vec);
    CharacterPack::from_parts(manifest, tensors).unwrap()
}

#[test]
fn a_pack_brings_its_mesh() {
    let pack = humanoid(Some(HUMANOID_GLB));
    let model = sim::model_of(&pack).unwrap();
    let (looks, complaint) = appearance::of_pack(&pack, &model);
    let expected = SkinnedMesh::from_bytes(HUMANOID_GLB, &appearance::rig(&model)).unwrap();
    assert!(looks.mesh() == Some(&expected) && complaint.is_none());
    // A mesh that is none is said, and the mannequin takes its place.
    let broken = humanoid(Some(b"no mesh"));
    let (looks, complaint) = appearance::of_pack(&broken, &model);
    assert!(looks.mesh() == Some(&expected));
    assert!(complaint.is_some_and(|said| said.contains("the mesh of the pack")));
}

#[test]
fn a_dropped_pack_is_opened_and_a_bad_one_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("quadruped.pack.safetensors");
    std::fs::write(&path, quadruped().to_bytes()).unwrap();
    let bad = folder.path().join("bad.pack.safetensors");
    let mut pack = quadruped().manifest().clone();
    pack.mjcf = Some("<mujoco/>".into());
    let pack = CharacterPack::from_parts(pack, quadruped().tensors().clone()).unwrap();
    std::fs::write(&bad, pack.to_bytes()).unwrap();

    let mut app = App::new(simulation(), PanelLayout::default());
    let humanoid = app.sim.player().state.bodies.len();
    let said = app.open_dropped(&bad).map(|_| ()).unwrap_err().to_string();
    assert!(said.contains("bad.pack.safetensors"), "{said}");
    assert_eq!(app.sim.player().state.bodies.len(), humanoid);
    assert!(app.tick().is_empty());
    let (what, looks) = app.open_dropped(&path).unwrap();
    assert_eq!((what, looks.mesh().is_none()), ("character pack", true));
    assert_ne!(app.sim.player().state.bodies.len(), humanoid);
    assert!(app.tick().is_empty());
    // The humanoid's mesh does not fit it.
    let mesh = folder.path().join("humanoid.glb");
    std::fs::write(&mesh, HUMANOID_GLB).unwrap();
    let said = app.open_dropped(&mesh).map(|_| ()).unwrap_err().to_string();
    assert!(said.contains("humanoid.glb") && said.contains("found none named"), "{said}");
}

#[test]
fn a_dropped_pack_is_drawn_as_what_it_is() {
    let Some(gpu) = gpu() else { return };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("quadruped.pack.safetensors");
    std::fs::write(&path, quadruped().to_bytes()).unwrap();
    let mut app = App::new(simulation(), PanelLayout::default());
    let (looks, _) = appearance::of_pack(app.sim.pack(), app.sim.model());
    let mut composer = FrameComposer::new(&gpu, OffScreen::FORMAT, looks);
    for dropped in [vec![], vec![path]] {
        app.dropped = dropped;
        let output = composer.panels(&mut app, egui::RawInput::default());
        composer.picture(&mut app, output, [160, 120], false).unwrap();
    }
    assert!(app.toasts.take_text().is_some_and(|said| said.contains("Opened the character pack")));
    assert!(!app.has_mesh && composer.appearance().mesh().is_none());
}

#[test]
fn a_dropped_mesh_is_drawn_and_the_demo_says_so() {
    let Some(gpu) = gpu() else { return };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("own.glb");
    std::fs::write(&path, HUMANOID_GLB).unwrap();
    let mut app = App::new(simulation(), PanelLayout::default());
    let bare = viewer::render::Appearance::new(app.sim.pack().skeleton(), None);
    let mut composer = FrameComposer::new(&gpu, OffScreen::FORMAT, bare);
    app.has_mesh = false;
    app.dropped = vec![path];
    let output = composer.panels(&mut app, egui::RawInput::default());
    composer.picture(&mut app, output, [160, 120], false).unwrap();
    assert!(
        app.toasts
            .take_text()
            .is_some_and(|said| said.contains("Opened the mesh") && said.contains("own.glb"))
    );
    assert!(app.has_mesh && composer.appearance().mesh().is_some());
}

#[test]
fn both_versions_of_a_pack_and_renewed_controllers_give_the_same_state() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("two.pack"), humanoid(None).to_bytes()).unwrap();
    std::fs::write(folder.path().join("four.pack"), quadruped().to_bytes()).unwrap();
    let hash = |more: &[&str]| {
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/scripts/tour.ron");
        let output = Command::new(env!("CARGO_BIN_EXE_policy-space"))
            .current_dir(folder.path())
            .args(["--headless", "--script", script, "--seconds", "20", "--report", "r.json"])
            .args(more)
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let report: serde_json::Value =
            serde_json::from_slice(&std::fs::read(folder.path().join("r.json")).unwrap()).unwrap();
        report["state_hash"].as_str().unwrap().to_owned()
    };
    let plain = hash(&[]);
    assert_eq!(hash(&["--character", "two.pack"]), plain);
    assert_eq!(hash(&["--renew-controllers"]), plain);
    assert_eq!(hash(&["--pack", "two.pack", "--renew-controllers"]), plain);
    assert_ne!(hash(&["--character", "four.pack"]), plain);
    assert_eq!(
        hash(&["--character", "four.pack", "--renew-controllers"]),
        hash(&["--character", "four.pack"])
    );
}

#[test]
fn a_crowd_of_quadrupeds_walks_on_hills() {
    let config = sim::SimConfig {
        ground: sim::GroundKind::Wavy,
        characters: 8,
        history: true,
        ..sim::SimConfig::default()
    };
    let mut world = sim::Simulation::new(Arc::new(quadruped()), config).unwrap();
    let pad = GamepadState { left_stick: [0.0, 1.0], ..GamepadState::default() };
    for _ in 0..60 {
        assert!(world.tick(&pad, Heading::FORWARD).is_empty());
    }
    assert!(world.characters().iter().all(|c| c.state.is_finite()));
    world.rewind_to(30);
    assert!(world.tick(&pad, Heading::FORWARD).is_empty());
}
