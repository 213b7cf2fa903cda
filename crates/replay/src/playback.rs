//! Gives the pads of a replay back, tick by tick, and compares hashes.

use crate::header::Replay;
use crate::pad::Pad;

/// The state differs from the recorded one: playing ends here.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "after tick {tick} of the replay: expected the state {expected:016x}, found {found:016x}; the last equal state is \
     that after tick {equal}"
)]
pub struct Mismatch {
    /// The first tick whose hash differs, from 1.
    pub tick: u32,
    /// The last tick whose hash was compared and equal; 0 for the start.
    pub equal: u32,
    /// The recorded hash.
    pub expected: u64,
    /// The hash found.
    pub found: u64,
}

/// Where one player is in its runs.
#[derive(Clone, Copy, Debug, Default)]
struct Cursor {
    run: usize,
    /// Ticks of the run that are over.
    ticks: u32,
}

/// Plays a replay once.
#[derive(Clone, Debug)]
pub struct Playback {
    replay: Replay,
    cursors: Vec<Cursor>,
    pads: Vec<Pad>,
    tick: u32,
    equal: u32,
}

impl Playback {
    /// At the start of a replay. Copies it.
    #[must_use]
    pub fn new(replay: &Replay) -> Self {
        let players = replay.runs.len();
        Self {
            replay: replay.clone(),
            cursors: vec![Cursor::default(); players],
            pads: vec![Pad::default(); players],
            tick: 0,
            equal: 0,
        }
    }

    /// The replay.
    #[must_use]
    pub fn replay(&self) -> &Replay {
        &self.replay
    }

    /// Ticks given out.
    #[must_use]
    pub fn tick(&self) -> u32 {
        self.tick
    }

    /// The pads of the next tick, one for each player; `None` at the end. Allocates nothing.
    pub fn next_pads(&mut self) -> Option<&[Pad]> {
        if self.tick >= self.replay.ticks {
            return None;
        }
        for ((cursor, runs), pad) in self.cursors.iter_mut().zip(&self.replay.runs).zip(&mut self.pads) {
            let run = runs.0[cursor.run];
            *pad = run.pad;
            cursor.ticks += 1;
            if cursor.ticks == run.ticks {
                *cursor = Cursor { run: cursor.run + 1, ticks: 0 };
            }
        }
        self.tick += 1;
        Some(&self.pads)
    }

    /// Compares the hash of the state after the tick whose pads were given out last. Most ticks have no recorded hash, and
    /// pass.
    ///
    /// # Errors
    /// When it differs from the recorded one.
    pub fn check(&mut self, found: u64) -> Result<(), Mismatch> {
        let (tick, every) = (self.tick, u32::from(self.replay.header.hash_every));
        let recorded = match tick {
            0 => None,
            _ if tick.is_multiple_of(every) => self.replay.hashes.get((tick / every) as usize - 1).copied(),
            _ if tick == self.replay.ticks => Some(self.replay.last_hash),
            _ => None,
        };
        match recorded {
            Some(expected) if expected != found => Err(Mismatch { tick, equal: self.equal, expected, found }),
            Some(_) => {
                self.equal = tick;
                Ok(())
            }
            None => Ok(()),
        }
    }
}
