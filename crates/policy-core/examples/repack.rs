//! Reads a pack and writes it again: the same pack always gives the same bytes.
//!
//! `cargo run --example repack -- IN OUT`

use policy_core::CharacterPack;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut args = std::env::args().skip(1);
    let (from, to) = args.next().zip(args.next()).ok_or("expected the paths of two packs: IN OUT")?;
    let pack = CharacterPack::from_bytes(&std::fs::read(from)?)?;
    std::fs::write(to, pack.to_bytes())?;
    Ok(())
}
