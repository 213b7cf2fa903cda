//! The parts of the example: the arena as GGRS wants it, a made-up network, and the three runs.

pub mod cost;
pub mod game;
pub mod network;
pub mod play;
pub mod sync_test;
