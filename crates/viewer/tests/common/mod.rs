//! What the tests of this folder share.
#![allow(dead_code, reason = "each test file uses a part")]

use std::sync::Arc;

use policy_core::CharacterPack;
use viewer::app::{App, Layout, PanelKind, Side};
use viewer::assets;
use viewer::gpu::Gpu;
use viewer::sim::{SimConfig, Simulation};

/// A world of one character that keeps its history.
pub fn simulation() -> Simulation {
    simulation_of(Arc::new(CharacterPack::from_bytes(assets::HUMANOID_PACK).unwrap()))
}

/// The same with a pack of one's own.
pub fn simulation_of(pack: Arc<CharacterPack>) -> Simulation {
    let config = SimConfig { history: true, ..SimConfig::default() };
    Simulation::new(assets::HUMANOID_MJCF, pack, config).unwrap()
}

/// The demo with one panel open.
pub fn app_with(kind: PanelKind) -> App {
    let layout = Layout { open: vec![(kind, Side::Left)], ..Layout::default() };
    App::new(simulation(), layout)
}

/// A device, or a message that says why the test is skipped.
pub fn gpu() -> Option<Gpu> {
    match Gpu::off_screen() {
        Ok(gpu) => Some(gpu),
        Err(error) => {
            eprintln!("skipped: {error}");
            None
        }
    }
}
