//! The least time of a physics step in each engine, microseconds, while the humanoid walks: sensing and policy are left
//! out. Rounds take turns, so that both engines see the same machine.
//!
//! `cargo run --release -p physics --example bench_step -- [--json]`

use std::sync::Arc;
use std::time::{Duration, Instant};

use physics::{Character, Engine, Model, PhysicsCharacter};
use policy_core::glam::Vec2;
use policy_core::{CharacterPack, CharacterState, Command, Controller, ControllerConfig, Goal, Heading};

const PACK: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/humanoid.pack.safetensors");
const MJCF: &str = include_str!("../../../assets/humanoid.xml");
const TICKS: usize = 300;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let pack = Arc::new(CharacterPack::from_bytes(&std::fs::read(PACK)?)?);
    let walk = pack.graph().node_named("walk").ok_or("expected a node walk")?;
    let described = physics_bridge::Model::from_mjcf_with_skeleton(MJCF, Arc::clone(pack.skeleton()))?;
    let config = ControllerConfig { start: walk, ..ControllerConfig::default() };
    let mut least = Vec::new();
    for engine in Engine::ALL {
        let mut character = Character::new(&Model::new(&described, engine)?);
        character.stand_at(0.0, 0.0, Heading::FORWARD, physics_bridge::WALKING_START_MPS)?;
        let controller = Controller::with_config(Arc::clone(&pack), config);
        let state = CharacterState::new(pack.skeleton());
        least.push((engine, character, controller, state, Duration::MAX));
    }
    for _ in 0..TICKS {
        for (_, character, controller, state, least) in &mut least {
            character.sense_into(state);
            let target = Some(state.root().position.truncate() + Vec2::new(5.0, 0.0));
            let command = Command { target, goal: Goal::Node(walk), ..Command::default() };
            character.actuate(controller.tick(state, &command, 1.0 / character.control_hz()));
            let start = Instant::now();
            character.step()?;
            *least = start.elapsed().min(*least);
        }
    }
    let figure = |(engine, .., least): &(Engine, _, _, _, Duration)| {
        let step = least.as_secs_f64() * 1e6 / f64::from(described.substeps());
        (engine.name(), (step * 10.0).round() / 10.0)
    };
    if std::env::args().any(|word| word == "--json") {
        let figures: Vec<String> =
            least.iter().map(figure).map(|(name, us)| format!("\"{name}_step_us\": {us}")).collect();
        println!("{{{}}}", figures.join(", "));
    } else {
        least.iter().map(figure).for_each(|(name, us)| println!("{name:8} {us:8.1} us a physics step"));
    }
    Ok(())
}
