//! Makes the demo of a command line: world, layout, appearance.

use std::path::PathBuf;

use anyhow::bail;

use super::{Demo, GhostChoice, load};
use crate::app::{App, Best, PanelKind, PanelLayout, Side, Toasts};
use crate::dropped::word_about;
use crate::render::Appearance;
use crate::sim::{GhostKind, Playback, SimConfig, Simulation};

/// What a window needs.
#[derive(Debug)]
pub struct Opened {
    /// The demo.
    pub app: App,
    /// How characters are drawn.
    pub appearance: Appearance,
    /// Where its layout is kept, when it is.
    pub layout: Option<PathBuf>,
}

/// Makes the demo. Of a mesh or layout that is no good [`App::toasts`] says so, and the default is used.
///
/// # Errors
/// When the pack or the clip is no good, or the world can't be made.
pub fn open(demo: &Demo) -> anyhow::Result<Opened> {
    let mut toasts = Toasts::default();
    // A clip needs other panels than the demo, whose layout it leaves alone.
    let clip = demo.poses.as_deref();
    let mut home = if demo.no_layout || demo.headless || clip.is_some() { None } else { PanelLayout::home() };
    let (mut layout, said, may_save) =
        home.as_deref().map_or((PanelLayout::default(), None, true), PanelLayout::load_or_keep_aside);
    said.into_iter().for_each(|said| toasts.error(said));
    home = home.filter(|_| may_save);
    // A clip has nothing to steer, and who asks for panels gets them.
    layout.preferences.advanced |= clip.is_some() || demo.panels.is_some();
    if clip.is_some() {
        layout.open =
            [PanelKind::Physics, PanelKind::View, PanelKind::Record].map(|kind| (kind, Side::Left)).into();
    }
    if let Some(list) = demo.panels.as_ref().filter(|list| !list.0.is_empty()) {
        layout.open.clear();
        // In turn to the left and to the right.
        layout.open.extend(list.0.iter().copied().zip([Side::Left, Side::Right].into_iter().cycle()));
    }
    let pack = load::pack(demo.character.as_deref())?;
    // The pack inside the demo is checked with the program.
    let word = demo.character.as_ref().and_then(|_| word_about(&pack));
    if demo.headless {
        word.into_iter().for_each(super::remark);
    } else {
        word.into_iter().for_each(|word| toasts.note(word));
    }
    let scene = demo.scene();
    let config = SimConfig {
        scene,
        engine: demo.physics,
        ground: demo.terrain,
        characters: demo.characters.unwrap_or(scene.usual_characters()),
        seed: demo.seed,
        history: !demo.headless && clip.is_none(),
        comparison: false,
    };
    let config = if demo.compare { config.compared() } else { config };
    let mut sim = Simulation::new(pack, config)?;
    if demo.second_script.is_some() && !sim.has_second_character() {
        bail!("--second-script needs the playground with at least 2 characters");
    }
    sim.set_blend_mode(demo.mode);
    sim.renews_controllers = demo.renew_controllers;
    let (appearance, complaint) = load::appearance(demo.mesh.as_deref(), sim.pack(), sim.model());
    complaint.into_iter().for_each(|complaint| toasts.error(complaint));
    if let Some(path) = clip {
        let playback = Playback::load(path, sim.model())?;
        sim.play(playback);
    }
    if let Some(choice) = demo.ghost {
        sim.start_ghost(match choice {
            GhostChoice::OtherEngine => GhostKind::Engine(demo.physics.other()),
            GhostChoice::Kind(kind) => kind,
        })?;
    }
    let mut app = App::new(sim, layout);
    if let Some(home) = &home {
        app.best = Best::beside(home.clone());
    }
    app.has_mesh = appearance.mesh().is_some();
    if let Some(distance) = demo.distance {
        app.camera.distance = distance;
    }
    app.toasts = toasts;
    if demo.tour {
        app.tour.start();
    }
    Ok(Opened { app, appearance, layout: home })
}
