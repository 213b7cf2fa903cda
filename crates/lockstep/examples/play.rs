//! Plays a replay of an arena without drawing it and compares the state every second: a file, or the text of a link in a
//! file that ends in `.link`. Prints one JSON object.
//!
//! `cargo run --release -p lockstep --features deterministic --example play -- PACK REPLAY`

use std::process::ExitCode;

use lockstep::{Arena, ArenaConfig};
use replay::{MOST_BYTES, Playback, Replay};

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    match program(&words) {
        Ok(line) => {
            println!("{line}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn program(words: &[String]) -> Result<String, Box<dyn std::error::Error>> {
    let [pack, path] = words else { return Err("expected PACK REPLAY".into()) };
    let pack = std::fs::read(pack).map_err(|error| format!("cannot read {pack}: {error}"))?;
    let length = std::fs::metadata(path).map_err(|error| format!("cannot read {path}: {error}"))?.len();
    if length > MOST_BYTES as u64 {
        return Err(format!("expected a replay of at most {MOST_BYTES} bytes, found {length}").into());
    }
    let replay = if path.ends_with(".link") {
        Replay::from_link(std::fs::read_to_string(path)?.trim())?
    } else {
        Replay::from_bytes(&std::fs::read(path)?)?
    };
    let mut arena = Arena::new(&pack, ArenaConfig::of(replay.header())?)?;
    arena.header().expect(replay.header())?;
    let mut playback = Playback::new(&replay);
    while let Some(pads) = playback.next_pads() {
        arena.tick(pads)?;
        playback.check(arena.hash())?;
    }
    Ok(format!(
        "{{\"ticks\": {}, \"equal\": {}, \"hash\": \"{:016x}\"}}",
        playback.tick(),
        arena.hash() == replay.last_hash(),
        arena.hash()
    ))
}
