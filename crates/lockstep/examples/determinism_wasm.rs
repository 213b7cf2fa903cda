//! The run of `determinism` for wasm32 without a binding generator: whoever loads the module writes a pack into its memory
//! and asks for hashes.
//!
//! `pack_memory(len)` returns where to write, `run(players)` the number of hashes or -1, `hash_high` and `hash_low` the two
//! halves of a hash: the one after each second, then the last.

#[path = "support/run.rs"]
mod run;

use std::sync::Mutex;

/// The bytes of the pack, and the hashes of the run.
static PACK: Mutex<Vec<u8>> = Mutex::new(Vec::new());
static HASHES: Mutex<Vec<u64>> = Mutex::new(Vec::new());

/// Makes room for a pack of so many bytes and returns its address. Null when the memory is in use.
#[unsafe(no_mangle)]
pub extern "C" fn pack_memory(len: u32) -> *mut u8 {
    PACK.lock().map_or(std::ptr::null_mut(), |mut pack| {
        *pack = vec![0; len as usize];
        pack.as_mut_ptr()
    })
}

/// Runs the script; returns how many hashes there are, or -1 when the pack is no pack.
#[unsafe(no_mangle)]
pub extern "C" fn run(players: u32) -> i32 {
    let (Ok(pack), Ok(mut hashes)) = (PACK.lock(), HASHES.lock()) else { return -1 };
    match run::script(&pack, players as usize) {
        Ok(ran) => {
            *hashes = ran.hashes;
            hashes.push(ran.last_hash);
            hashes.len() as i32
        }
        Err(_) => -1,
    }
}

/// The high half of a hash; 0 when there is none.
#[unsafe(no_mangle)]
pub extern "C" fn hash_high(index: u32) -> u32 {
    (hash(index) >> 32) as u32
}

/// The low half of a hash; 0 when there is none.
#[unsafe(no_mangle)]
pub extern "C" fn hash_low(index: u32) -> u32 {
    hash(index) as u32
}

fn hash(index: u32) -> u64 {
    HASHES.lock().ok().and_then(|hashes| hashes.get(index as usize).copied()).unwrap_or(0)
}
