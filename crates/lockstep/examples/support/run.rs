//! The run that `determinism` and `determinism_wasm` share.

use lockstep::{Arena, ArenaConfig, ArenaError, Pad, SCRIPT_TICKS, Seen, script_pad};

/// What a run came to.
#[allow(dead_code, reason = "each of the two programs uses its part")]
#[derive(Clone, Debug, PartialEq)]
pub struct Ran {
    /// After each second.
    pub hashes: Vec<u64>,
    /// After the last tick.
    pub last_hash: u64,
    /// Of the first player.
    pub seen: Seen,
}

/// Runs the whole script with so many players and four crates.
pub fn script(pack: &[u8], players: usize) -> Result<Ran, ArenaError> {
    let mut arena = Arena::new(pack, ArenaConfig { players, ..ArenaConfig::default() })?;
    let every = u32::from(arena.header().hash_every);
    let mut ran = Ran { hashes: Vec::new(), last_hash: 0, seen: Seen::default() };
    for tick in 0..SCRIPT_TICKS {
        let pads: Vec<Pad> = (0..players).map(|player| script_pad(tick, player)).collect();
        arena.tick(&pads)?;
        ran.seen.look(&arena);
        if (tick + 1).is_multiple_of(every) {
            ran.hashes.push(arena.hash());
        }
    }
    ran.last_hash = arena.hash();
    Ok(ran)
}
