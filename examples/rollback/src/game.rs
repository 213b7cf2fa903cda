//! The arena as GGRS wants it: a plain input, a state to save and load, and requests that are met in their order.

use std::collections::BTreeMap;

use anyhow::Context as _;
use ggrs::{Config, Frame, GgrsRequest, PredictRepeatLast};
use lockstep::{Arena, ArenaConfig, ArenaState, Pad};
use serde::{Deserialize, Serialize};

/// The pack of both players.
pub const PACK: &[u8] =
    include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/humanoid.pack.safetensors"));

/// GGRS's types for the arena. A held stick is the best guess at what the other player does next.
#[derive(Debug)]
pub struct Netplay;

impl Config for Netplay {
    type Input = PadBytes;
    type InputPredictor = PredictRepeatLast;
    type State = ArenaState;
    type Address = usize;
}

/// A pad on its way over the network.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PadBytes([u8; Pad::BYTES]);

impl From<Pad> for PadBytes {
    fn from(pad: Pad) -> Self {
        Self(pad.to_bytes())
    }
}

/// One player's copy of the game.
#[derive(Debug)]
pub struct Game {
    arena: Arena,
    /// The hash of each frame as it was saved last.
    hashes: BTreeMap<Frame, u64>,
    /// Frames run, those that were taken back included.
    pub run: u32,
    /// Times that a state was loaded.
    pub rollbacks: u32,
    /// Most frames that were run again at once.
    pub deepest: u32,
}

impl Game {
    /// A game at its start.
    ///
    /// # Errors
    /// When the arena can't be made.
    pub fn new(players: usize) -> anyhow::Result<Self> {
        let arena = Arena::new(PACK, ArenaConfig { players, ..ArenaConfig::default() })?;
        Ok(Self { arena, hashes: BTreeMap::new(), run: 0, rollbacks: 0, deepest: 0 })
    }

    /// Meets GGRS's requests, in their order.
    ///
    /// # Errors
    /// When a state that is to be loaded was never saved, or the arena refuses it.
    pub fn handle(&mut self, requests: Vec<GgrsRequest<Netplay>>) -> anyhow::Result<()> {
        let rolls_back = requests.iter().any(|request| matches!(request, GgrsRequest::LoadGameState { .. }));
        let advances =
            requests.iter().filter(|request| matches!(request, GgrsRequest::AdvanceFrame { .. })).count();
        if rolls_back {
            // The last of them is the new frame.
            self.deepest = self.deepest.max(advances as u32 - 1);
        }
        for request in requests {
            match request {
                GgrsRequest::SaveGameState { cell, frame } => {
                    let hash = self.arena.hash();
                    self.hashes.insert(frame, hash);
                    cell.save(frame, Some(self.arena.save()), Some(hash.into()));
                }
                GgrsRequest::LoadGameState { cell, frame } => {
                    let state = cell.data().with_context(|| format!("frame {frame} was never saved"))?;
                    self.arena.restore(&state)?;
                    self.rollbacks += 1;
                }
                GgrsRequest::AdvanceFrame { inputs } => {
                    let pads: Vec<Pad> = inputs.iter().map(|(input, _)| Pad::from_bytes(input.0)).collect();
                    self.arena.tick(&pads)?;
                    self.run += 1;
                }
            }
        }
        Ok(())
    }

    /// The hash of each frame, as it was saved last.
    #[must_use]
    pub fn hashes(&self) -> &BTreeMap<Frame, u64> {
        &self.hashes
    }

    /// The arena.
    #[must_use]
    pub fn arena(&self) -> &Arena {
        &self.arena
    }
}
