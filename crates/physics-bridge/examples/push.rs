//! A gait that is pushed: prints which policies act in each tick, and writes the poses to watch them.
//!
//! `cargo run --release -p physics-bridge --example push -- 0 320 push.json run` pushes a run by 320 N to the left, then
//! `cargo xtask demo -- --poses push.json` shows it.

use std::sync::Arc;

use physics_bridge::{Character, Model};
use policy_core::glam::{Vec2, Vec3};
use policy_core::{CharacterPack, Command, Controller, Goal, Heading};

const PACK: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/humanoid.pack.safetensors");

/// The tick in which the push begins, the first one that is written, and how many there are.
const TICKS: [u32; 3] = [95, 85, 170];

/// How long the push lasts, seconds.
const PUSH_SECS: f32 = 0.2;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [ahead, left, file, gait] = &arguments[..] else {
        return Err("expected newtons ahead, newtons to the left, a file to write and a gait".into());
    };
    let force = Vec3::new(ahead.parse()?, left.parse()?, 0.0);
    let pack = Arc::new(CharacterPack::from_bytes(&std::fs::read(PACK)?)?);
    let model = Model::for_pack(&pack)?;
    let graph = pack.graph();
    let goal = Goal::Node(graph.node_named(gait).ok_or("expected a gait of the pack, such as walk")?);
    let torso = model.skeleton().body_named("torso").ok_or("expected a body named torso")?;
    let mut character = Character::new(&model);
    character.stand_at(0.0, 0.0, Heading::FORWARD, 0.0)?;
    let mut controller = Controller::new(pack.clone());

    let mut poses = Vec::new();
    for tick in 0..TICKS[2] {
        // As a stick does: the target stays ahead.
        let target = character.sensed().root().position.truncate() + Vec2::new(10.0, 0.0);
        if tick == TICKS[0] {
            character.push(torso, force, PUSH_SECS)?;
        }
        let command = Command { target: Some(target), goal, ..Command::default() };
        character.control_tick(&mut controller, &command, 1.0 / model.control_hz())?;
        if tick < TICKS[1] {
            continue;
        }
        let numbers: Vec<String> = character.pose().qpos.iter().map(|q| format!("{q:.6}")).collect();
        poses.push(format!("[{}]", numbers.join(",")));
        let terms = controller.report().blend.terms().iter();
        let names = terms.map(|t| format!("{:.2} {}", t.weights[0], graph.nodes()[t.policy.index()].name));
        println!("{tick} {}", names.collect::<Vec<_>>().join(", "));
    }
    let (hz, rows) = (model.control_hz(), poses.join(","));
    let text =
        format!("{{\"format\":\"policy-space poses\",\"clip\":\"push\",\"hz\":{hz:?},\"qpos\":[{rows}]}}");
    Ok(std::fs::write(file, text)?)
}
