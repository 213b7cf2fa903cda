//! What a rollback costs: saving, restoring and running 8 frames again.

use std::fmt::Write as _;
use std::time::{Duration, Instant};

use lockstep::{Arena, ArenaConfig, Pad, script_pad};

use crate::game::PACK;

/// Numbers of characters that are measured.
const CHARACTERS: [usize; 3] = [1, 2, 8];
/// Frames of a rollback.
const FRAMES: u32 = 8;
/// Frames before the first measurement, and measurements.
const BEFORE: u32 = 60;
const TIMES: u32 = 60;

/// Medians of one number of characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cost {
    /// Of one save.
    pub save: Duration,
    /// Of one restore.
    pub restore: Duration,
    /// Of 8 frames with a save each, as GGRS asks for them.
    pub frames: Duration,
}

/// Measures so many characters that walk, beside four crates.
///
/// # Errors
/// When the arena can't be made.
pub fn measure(players: usize, times: u32) -> anyhow::Result<Cost> {
    let mut arena = Arena::new(PACK, ArenaConfig { players, ..ArenaConfig::default() })?;
    let pads = |tick: u32| -> Vec<Pad> { (0..players).map(|player| script_pad(tick, player)).collect() };
    let (mut saves, mut restores, mut runs) = (Vec::new(), Vec::new(), Vec::new());
    for tick in 0..BEFORE {
        arena.tick(&pads(tick))?;
    }
    for time in 0..times {
        let start = Instant::now();
        let saved = arena.save();
        saves.push(start.elapsed());
        arena.tick(&pads(BEFORE + time))?;
        let start = Instant::now();
        arena.restore(&saved)?;
        restores.push(start.elapsed());
        let start = Instant::now();
        for frame in 0..FRAMES {
            arena.tick(&pads(BEFORE + time + frame))?;
            drop(std::hint::black_box(arena.save()));
        }
        runs.push(start.elapsed());
        arena.restore(&saved)?;
        arena.tick(&pads(BEFORE + time))?;
    }
    Ok(Cost { save: median(saves), restore: median(restores), frames: median(runs) })
}

/// The table of all three, in Markdown.
///
/// # Errors
/// As [`measure`].
pub fn table() -> anyhow::Result<String> {
    let mut out =
        String::from("| characters | save | restore | 8 frames again, each saved |\n|---|---|---|---|\n");
    for players in CHARACTERS {
        let cost = measure(players, TIMES)?;
        let us = |time: Duration| format!("{} us", time.as_micros());
        let frames = format!("{:.1} ms", cost.frames.as_secs_f64() * 1e3);
        writeln!(out, "| {players} | {} | {} | {frames} |", us(cost.save), us(cost.restore))?;
    }
    Ok(out)
}

fn median(mut times: Vec<Duration>) -> Duration {
    times.sort();
    times.get(times.len() / 2).copied().unwrap_or_default()
}
