//! Falls while the trigger sweeps over a path, or how often a skill succeeds, in one physics: a line of docs/rapier.md.
//!
//! `cargo run --release -p evaluation --example sweep -- ENGINE [PATH] [GROUND] [CHARACTERS] [SECONDS]`, such as
//! `rapier style flat 24 62`; with a skill in place of the path `rapier roll flat 200`.

use std::sync::Arc;

use evaluation::{measure_skill, measure_sweep};
use physics::{Engine, Model};
use physics_bridge::GroundKind;
use policy_core::{BlendMode, CharacterPack, ControllerConfig};

const PACK: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/humanoid.pack.safetensors");
const HILLS_SEED: u32 = 7;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let word = |index: usize, default: &str| words.get(index).map_or(default, String::as_str).to_owned();
    let engine = word(0, "rapier");
    let engine = Engine::ALL.into_iter().find(|e| e.name() == engine).ok_or("expected mujoco or rapier")?;
    let path = word(1, "style");
    let ground = GroundKind::from_name(&word(2, "flat")).ok_or("expected flat, wavy or steps")?;
    let (characters, secs): (usize, f32) = (word(3, "24").parse()?, word(4, "62").parse()?);

    let pack = Arc::new(CharacterPack::from_bytes(&std::fs::read(PACK)?)?);
    let described = physics_bridge::Model::for_pack(&pack)?.with_terrain(ground.terrain(HILLS_SEED))?;
    let model = Model::new(&described, engine)?;
    if let Some(skill) = pack.skill_named(&path) {
        let report = measure_skill(&model, &pack, ControllerConfig::default(), skill, characters);
        println!("{path}, {}: {report:?}", engine.title());
        return Ok(());
    }
    let index = pack.graph().path_named(&path).ok_or("expected a path or skill of the pack")?;
    let swept = measure_sweep(&model, &pack, index, BlendMode::Parameters, (characters, secs));
    let minutes = characters as f32 * secs / 60.0;
    println!(
        "{path}, {}, {}: {:.0} falls in {minutes:.1} minutes, {:.2} a minute; {:.2} rises by a skill a minute",
        ground.name(),
        engine.title(),
        swept.falls_per_character_minute * minutes,
        swept.falls_per_character_minute,
        swept.rises_by_skill_per_character_minute,
    );
    Ok(())
}
