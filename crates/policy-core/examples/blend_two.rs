//! Step 2: the straight line between two related policies is itself a policy. A blend is evaluated without building the
//! network in between.
//!
//! `cargo run -p policy-core --example blend_two`

use policy_core::{Arithmetic, Blend, CharacterPack, MlpScratch};

const PACK: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/humanoid.pack.safetensors");

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let pack = CharacterPack::from_bytes(&std::fs::read(PACK)?)?;
    let named = |name: &str| pack.policy_named(name).ok_or(format!("expected a policy {name}"));
    let (walk, jog) = (named("walk")?, named("jog")?);

    let policies = pack.policies();
    let distance = policies[walk.index()].squared_distance(&policies[jog.index()]).sqrt();
    println!("walk and jog are {distance:.2} apart in {} parameters", policies[0].parameter_count());

    let input = vec![0.1; policies[0].inputs()];
    let mut scratch = MlpScratch::for_mlp(&policies[0]);
    let mut action = vec![0.0; policies[0].outputs()];
    for t in [0.0, 0.25, 0.5, 0.75, 1.0] {
        let blend = Blend::between(walk, jog, t);
        blend.evaluate_into(policies, Arithmetic::Reproducible, &input, &mut scratch, &mut action);
        println!("t = {t:.2}: first joint {:+.4}", action[0]);
    }

    // Layers may be at different points of the line: here only the first one is half-way.
    let first_layer = Blend::between_per_layer(walk, jog, [0.5, 0.0, 0.0, 0.0]);
    first_layer.evaluate_into(policies, Arithmetic::Reproducible, &input, &mut scratch, &mut action);
    println!("first layer half-way: {:+.4}", action[0]);
    Ok(())
}
