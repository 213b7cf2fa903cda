//! Characters under the pads of their players, in one world, in fixed ticks: what lockstep and rollback netcode need.
//!
//! An [`Arena`] takes one [`Pad`] a player and tick and nothing else. The same pads give the same [`Arena::hash`] in debug
//! and release, after [`Arena::restore`], and with the feature `deterministic` on every machine. The crate knows no clock,
//! no network, no files and no drawing.
//!
//! ```
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/humanoid.pack.safetensors");
//! use lockstep::{Arena, ArenaConfig, Pad};
//!
//! let pack = std::fs::read(path)?;
//! let mut arena = Arena::new(&pack, ArenaConfig { players: 2, ..ArenaConfig::default() })?;
//! let forward = Pad { left_stick: [0, 127], ..Pad::default() };
//! let start = arena.save();
//! arena.tick(&[forward, Pad::default()])?;
//! let hash = arena.hash();
//! arena.restore(&start)?;
//! arena.tick(&[forward, Pad::default()])?;
//! assert_eq!(arena.hash(), hash);
//! # Ok(())
//! # }
//! ```
//!
//! # Features
//! `deterministic` turns on Rapier's `enhanced-determinism`: the same bits on every processor and under wasm32. Cargo
//! unites the features of one build, and this one makes glam scalar in every crate of it, so no build of the whole
//! workspace turns it on.

mod arena;
mod error;
mod loose;
mod player;
mod saved;
mod scene;
mod script;

pub use arena::{Arena, SHOVE_BUTTON};
pub use error::ArenaError;
pub use loose::{PUT_BUTTON, PropView, THROW_BUTTON};
pub use player::PlayerView;
pub use playground::LooseKind;
pub use replay::{Pad, StateHash};
pub use saved::ArenaState;
pub use scene::{ArenaConfig, ArenaScene, MOST_CRATES};
pub use script::{SCRIPT_TICKS, Seen, script_pad};
