//! What a replay holds.

use crate::error::ReplayError;
use crate::runs::Runs;

/// Most players.
pub const MOST_PLAYERS: usize = 8;
/// Most ticks: two hours at 60 Hz.
pub const MOST_TICKS: u32 = 432_000;
/// Longest name of a scene, bytes.
pub const MOST_SCENE_BYTES: usize = 64;

/// What a replay was played on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Header {
    /// [`StateHash::of`](crate::StateHash::of) the bytes of the character pack.
    pub pack_hash: u64,
    /// Seed of the scene.
    pub seed: u32,
    /// Ticks from one hash of the state to the next, from 1; usually those of a second.
    pub hash_every: u16,
    /// Players, 1 to [`MOST_PLAYERS`].
    pub players: u8,
    /// What was simulated, in words of whoever simulates: 1 to [`MOST_SCENE_BYTES`] of `a-z`, `0-9`, `-`, `.` and `/`.
    pub scene: String,
}

impl Header {
    /// Checks every field.
    ///
    /// # Errors
    /// When one is out of its range; the message names it.
    pub fn check(&self) -> Result<(), ReplayError> {
        let field = |field, expected, found: String, holds: bool| {
            if holds { Ok(()) } else { Err(ReplayError::Field { field, expected, found }) }
        };
        let players = usize::from(self.players);
        field("players", "1 to 8", players.to_string(), (1..=MOST_PLAYERS).contains(&players))?;
        field("hash_every", "1 or more ticks", self.hash_every.to_string(), self.hash_every > 0)?;
        let known = |byte: u8| byte.is_ascii_lowercase() || byte.is_ascii_digit() || b"-./".contains(&byte);
        let sized = (1..=MOST_SCENE_BYTES).contains(&self.scene.len());
        let found = self.scene.chars().take(MOST_SCENE_BYTES).collect::<String>();
        field(
            "scene",
            "1 to 64 characters of a-z, 0-9, `-`, `.` and `/`",
            format!("{found:?}"),
            sized && self.scene.bytes().all(known),
        )
    }

    /// Checks that a replay may be played on this: its pack, scene, seed and number of players.
    ///
    /// # Errors
    /// When one of them is another; the message names it.
    pub fn expect(&self, found: &Header) -> Result<(), ReplayError> {
        let same = |field, expected: String, found: String| {
            if expected == found { Ok(()) } else { Err(ReplayError::Other { field, expected, found }) }
        };
        same("pack", format!("{:016x}", self.pack_hash), format!("{:016x}", found.pack_hash))?;
        same("scene", self.scene.clone(), found.scene.clone())?;
        same("seed", self.seed.to_string(), found.seed.to_string())?;
        same("players", self.players.to_string(), found.players.to_string())
    }
}

/// The pads of every tick and the hashes between them. Takes the memory of what changes, not of the ticks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Replay {
    pub(crate) header: Header,
    pub(crate) ticks: u32,
    /// One for each player, all of [`Replay::ticks`].
    pub(crate) runs: Vec<Runs>,
    /// After every [`Header::hash_every`] ticks.
    pub(crate) hashes: Vec<u64>,
    /// After the last tick.
    pub(crate) last_hash: u64,
}

impl Replay {
    /// What it was played on.
    #[must_use]
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// Control ticks.
    #[must_use]
    pub fn ticks(&self) -> u32 {
        self.ticks
    }

    /// Hash of the state after the last tick.
    #[must_use]
    pub fn last_hash(&self) -> u64 {
        self.last_hash
    }

    /// Hashes of the state after every [`Header::hash_every`] ticks.
    #[must_use]
    pub fn hashes(&self) -> &[u64] {
        &self.hashes
    }
}
