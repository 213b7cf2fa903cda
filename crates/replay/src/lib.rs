//! Replays: what players pressed in each control tick, and a hash of the state every second.
//!
//! A [`Recorder`] takes the pads and the hash of each tick, a [`Replay`] is bytes or a link, a [`Playback`] gives the pads
//! back and compares hashes. The crate knows no physics and no files: whoever simulates brings the hash.
//!
//! ```
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! use replay::{Header, Pad, Playback, Recorder, Replay};
//!
//! let header = Header { pack_hash: 1, seed: 7, hash_every: 2, players: 1, scene: "empty".into() };
//! let mut recorder = Recorder::new(header)?;
//! for tick in 0..5 {
//!     recorder.push(&[Pad { left_stick: [0, 127], ..Pad::default() }], tick)?;
//! }
//! let replay = Replay::from_link(&recorder.finish().to_link()?)?;
//! let mut playback = Playback::new(&replay);
//! let mut tick = 0;
//! while let Some(pads) = playback.next_pads() {
//!     assert_eq!(pads[0].left_stick, [0, 127]);
//!     playback.check(tick)?; // the hash of the state after the tick
//!     tick += 1;
//! }
//! assert_eq!(tick, 5);
//! # Ok(())
//! # }
//! ```

mod bytes;
mod error;
mod hash;
mod header;
mod link;
mod pad;
mod playback;
mod recorder;
mod runs;

pub use bytes::{MOST_BYTES, checksum};
pub use error::ReplayError;
pub use hash::StateHash;
pub use header::{Header, MOST_PLAYERS, MOST_SCENE_BYTES, MOST_TICKS, Replay};
pub use link::MOST_LINK_CHARS;
pub use pad::Pad;
pub use playback::{Mismatch, Playback};
pub use recorder::Recorder;
