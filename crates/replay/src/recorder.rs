//! Makes a replay while a simulation runs.

use crate::bytes::MOST_BYTES;
use crate::error::ReplayError;
use crate::header::{Header, MOST_TICKS, Replay};
use crate::pad::Pad;
use crate::runs::Runs;

/// Takes the pads of each tick and the hash of the state after it.
#[derive(Clone, Debug)]
pub struct Recorder {
    replay: Replay,
    /// Bytes of the replay.
    len: usize,
}

impl Recorder {
    /// A recorder at the start of a simulation.
    ///
    /// # Errors
    /// When a field of the header is out of its range.
    pub fn new(header: Header) -> Result<Self, ReplayError> {
        header.check()?;
        let runs = vec![Runs::default(); header.players.into()];
        let len = Replay::empty_len(&header);
        Ok(Self { len, replay: Replay { header, ticks: 0, runs, hashes: Vec::new(), last_hash: 0 } })
    }

    /// Adds one tick: the pad of each player, and the hash of the state after it.
    ///
    /// # Errors
    /// When there are more or fewer pads than players, or the replay is as long as it may be; it is then unchanged.
    pub fn push(&mut self, pads: &[Pad], hash: u64) -> Result<(), ReplayError> {
        let replay = &mut self.replay;
        let field = |field, expected, found: usize| {
            Err(ReplayError::Field { field, expected, found: found.to_string() })
        };
        if pads.len() != replay.runs.len() {
            return field("the pads", "one for each player", pads.len());
        }
        if replay.ticks >= MOST_TICKS {
            return field("ticks", "at most 432000", MOST_TICKS as usize + 1);
        }
        let grown: usize = replay.runs.iter().zip(pads).map(|(runs, &pad)| runs.grows_by(pad)).sum();
        let is_hashed = (replay.ticks + 1).is_multiple_of(replay.header.hash_every.into());
        let len = self.len + grown + if is_hashed { 8 } else { 0 };
        if len > MOST_BYTES {
            return field("the pads", "no more changes than fit into a replay of 8 MiB", len);
        }
        self.len = len;
        for (runs, &pad) in replay.runs.iter_mut().zip(pads) {
            runs.push(pad);
        }
        replay.ticks += 1;
        replay.last_hash = hash;
        if is_hashed {
            replay.hashes.push(hash);
        }
        Ok(())
    }

    /// Ticks so far.
    #[must_use]
    pub fn ticks(&self) -> u32 {
        self.replay.ticks
    }

    /// The replay so far.
    #[must_use]
    pub fn replay(&self) -> &Replay {
        &self.replay
    }

    /// Ends the recording.
    #[must_use]
    pub fn finish(self) -> Replay {
        self.replay
    }
}
