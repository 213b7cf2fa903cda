//! Reads a character pack and says what is in it: the whole of loading is one call.
//!
//! `cargo run --example describe_pack -- assets/humanoid.pack.safetensors`

use policy_core::CharacterPack;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("expected the path of a pack")?;
    let pack = CharacterPack::from_bytes(&std::fs::read(path)?)?;

    for (node, policy) in pack.graph().nodes().iter().zip(pack.policies()) {
        println!("policy {:12} {} parameters", node.name, policy.parameter_count());
    }
    for edge in pack.graph().edges() {
        let [a, b] = edge.nodes.map(|n| &pack.graph().node(n).name);
        println!("edge   {a} - {b}: distance {:.2}, {} s", edge.distance, edge.seconds);
    }
    for path in pack.graph().paths() {
        let names: Vec<&str> = path.nodes().iter().map(|&n| pack.graph().node(n).name.as_str()).collect();
        println!("path   {:12} {}", path.name(), names.join(" - "));
    }
    for skill in pack.skills() {
        println!("skill  {:12} at most {} s", skill.name, skill.end.limit_seconds);
    }
    Ok(())
}
