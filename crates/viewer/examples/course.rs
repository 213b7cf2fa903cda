//! A pad that looks where it goes walks the course of the playground, once for each seed: checkpoints, time and falls.
//! A measure of the pack that ships and of the scene, not a check: `cargo run --release -p viewer --example course`.

use std::sync::Arc;

use glam::Vec2;
use playground::RaceState;
use policy_core::{CharacterPack, GamepadState, Heading};
use viewer::sim::{SceneKind, SimConfig, Simulation};

/// The way: x, y, left trigger, right trigger, each to within so many metres.
const WAY: [[f32; 5]; 22] = [
    [2.0, 0.0, 0.0, 0.0, 0.7],
    [11.7, 0.0, 0.0, 0.0, 0.7],
    [18.0, -0.1, 0.0, 0.0, 0.3],
    [20.8, -0.1, 0.0, 0.0, 0.7],
    [21.2, 3.0, 0.0, 0.0, 0.7],
    [20.2, 6.3, 0.0, 0.0, 0.7],
    [18.4, 6.3, 0.0, 0.0, 0.4],
    [14.4, 6.5, 0.0, 0.0, 0.8],
    [10.2, 8.0, 0.0, 0.0, 0.4],
    [5.6, 8.0, 0.0, 0.6, 1.0],
    [0.0, 7.6, 0.0, 0.0, 1.0],
    [-3.0, 6.4, 0.0, 0.0, 0.5],
    [-3.0, 2.0, 0.0, 0.0, 0.8],
    [-3.0, -5.0, 0.0, 0.0, 1.0],
    [-2.0, -8.0, 0.0, 0.0, 0.6],
    [0.5, -8.0, 0.0, 0.0, 0.3],
    [6.0, -8.0, 0.0, 0.0, 0.5],
    [7.6, -8.0, 1.0, 0.0, 0.4],
    [9.4, -8.0, 1.0, 0.0, 0.5],
    [13.0, -8.0, 1.0, 0.0, 0.5],
    [14.2, -8.0, 0.5, 0.0, 0.5],
    [15.0, -8.0, 0.0, 0.0, 0.7],
];
/// Longest run, seconds.
const MOST_SECS: f32 = 240.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let seeds = std::env::args().nth(1).map_or(Ok(3), |text| text.parse())?;
    let pack = Arc::new(CharacterPack::from_bytes(viewer::assets::HUMANOID_PACK)?);
    for seed in 1..=seeds {
        let config = SimConfig { scene: SceneKind::Playground, characters: 5, seed, ..SimConfig::default() };
        let mut sim = Simulation::new(Arc::clone(&pack), config)?;
        let (mut step, mut state, mut falls) = (0, RaceState::Waiting, Vec::new());
        let mut was_down = false;
        while step < WAY.len() && sim.ticks() as f32 * sim.tick_secs() < MOST_SECS {
            let [x, y, left_trigger, right_trigger, near] = WAY[step];
            let to = Vec2::new(x, y) - sim.player().position();
            step += usize::from(to.length() < near);
            let ahead = to.normalize_or_zero();
            let left_stick = [-ahead.y, ahead.x];
            let pad = GamepadState { left_stick, left_trigger, right_trigger, ..GamepadState::default() };
            sim.tick(&pad, Heading::FORWARD);
            let down = sim.player().is_down();
            if down && !was_down {
                falls.push(sim.player().position());
            }
            was_down = down;
            state = sim.shared().map_or(state, |shared| shared.race().state());
        }
        let secs = sim.shared().ok_or("expected a playground")?.race().secs(sim.tick_secs());
        println!(
            "seed {seed}: {state:?}, {step} points of {}, {secs:.1} s, {} falls",
            WAY.len(),
            falls.len()
        );
        for at in falls {
            println!("  fell at {at:.1}");
        }
    }
    Ok(())
}
