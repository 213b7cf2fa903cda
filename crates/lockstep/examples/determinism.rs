//! Runs the script of `lockstep` and prints one JSON object: the hash after each second, and what was seen.
//!
//! `cargo run -p lockstep --features deterministic --example determinism -- PACK [--players N] [--threads N]`. Each thread
//! runs an arena of its own at the same time, and all of them have to end in the same hashes.

#[path = "support/run.rs"]
mod run;

use std::process::ExitCode;

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    match program(&words) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn program(words: &[String]) -> Result<(), Box<dyn std::error::Error>> {
    let number = |name: &str| -> Result<usize, Box<dyn std::error::Error>> {
        match words.iter().position(|word| word == name) {
            None => Ok(1),
            Some(at) => {
                let value = words.get(at + 1).ok_or(format!("expected a number after {name}, found none"))?;
                Ok(value.parse().map_err(|_| format!("expected a number after {name}, found {value:?}"))?)
            }
        }
    };
    let (players, threads) = (number("--players")?, number("--threads")?);
    let path = words.first().ok_or("expected the path of a pack, found none")?;
    let pack = std::fs::read(path).map_err(|error| format!("cannot read {path}: {error}"))?;
    let start = std::time::Instant::now();
    let results: Vec<_> = std::thread::scope(|scope| {
        let handles: Vec<_> = (0..threads).map(|_| scope.spawn(|| run::script(&pack, players))).collect();
        handles.into_iter().map(|handle| handle.join().expect("a run does not panic")).collect()
    });
    let mut results = results.into_iter();
    let first = results.next().ok_or("expected at least one thread, found 0")??;
    for other in results {
        if other? != first {
            return Err("expected the same hashes in every thread, found others".into());
        }
    }
    let hashes: Vec<String> = first.hashes.iter().map(|hash| format!("\"{hash:016x}\"")).collect();
    println!(
        "{{\"hash\": \"{:016x}\", \"seconds\": {:.2}, \"top_speed_mps\": {:.2}, \"rolled\": {}, \"fell\": {}, \"got_up\": {}, \"hashes\": [{}]}}",
        first.last_hash,
        start.elapsed().as_secs_f64(),
        first.seen.top_speed_mps,
        first.seen.rolled,
        first.seen.fell,
        first.seen.got_up,
        hashes.join(", "),
    );
    Ok(())
}
