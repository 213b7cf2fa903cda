//! Makes the demo of a command line: world, layout, mesh.

use std::path::PathBuf;

use super::{Demo, load};
use crate::app::{App, Layout, PanelKind, Side};
use crate::assets;
use crate::mesh::SkinnedMesh;
use crate::sim::{Playback, SimConfig, Simulation};

/// What a window needs.
#[derive(Debug)]
pub struct Opened {
    /// The demo.
    pub app: App,
    /// The humanoid.
    pub mesh: SkinnedMesh,
    /// Where its layout is kept, when it is.
    pub layout: Option<PathBuf>,
}

/// Makes the demo. A mesh or layout that is no good is said in [`App::notice`], and the default taken.
///
/// # Errors
/// When the pack or the clip is no good, or the world can't be made.
pub fn open(demo: &Demo) -> anyhow::Result<Opened> {
    let mut notices = Vec::new();
    // A clip needs other panels than the demo, whose layout it leaves alone.
    let clip = demo.poses.as_deref();
    let home = if demo.no_layout || demo.headless || clip.is_some() { None } else { Layout::home() };
    let mut layout = match home.as_deref().map(Layout::load) {
        Some(Ok(layout)) => layout,
        Some(Err(error)) => {
            notices.push(error.to_string());
            Layout::default()
        }
        None => Layout::default(),
    };
    if clip.is_some() {
        layout.open =
            [PanelKind::Physics, PanelKind::View, PanelKind::Record].map(|kind| (kind, Side::Left)).into();
    }
    if let Some(list) = demo.panels.as_ref().filter(|list| !list.0.is_empty()) {
        layout.open.clear();
        // In turn to the left and to the right.
        layout.open.extend(list.0.iter().copied().zip([Side::Left, Side::Right].into_iter().cycle()));
    }
    let (mesh, complaint) = load::mesh(demo.mesh.as_deref())?;
    notices.extend(complaint);
    let pack = load::pack(demo.pack.as_deref())?;
    let config = SimConfig {
        ground: demo.terrain,
        characters: demo.characters,
        seed: demo.seed,
        history: !demo.headless && clip.is_none(),
    };
    let mut sim = Simulation::new(assets::HUMANOID_MJCF, pack, config)?;
    sim.overrides.mode = demo.mode;
    if let Some(path) = clip {
        let playback = Playback::load(path, sim.model())?;
        sim.play(playback);
    }
    if let Some(mode) = demo.ghost {
        sim.start_ghost(mode);
    }
    let mut app = App::new(sim, layout);
    if let Some(distance) = demo.distance {
        app.camera.distance = distance;
    }
    app.notice = (!notices.is_empty()).then(|| notices.join("\n"));
    Ok(Opened { app, mesh, layout: home })
}
