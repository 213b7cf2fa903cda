//! A replay as bytes, little-endian.
//!
//! Order: magic, version, hash interval, pack hash, seed, players, scene, ticks, the pads of each player, the hashes, the
//! last hash, a checksum. Whoever reads allocates in step with the bytes that are there, never by a number in them.

use crate::error::ReplayError;
use crate::hash::StateHash;
use crate::header::{Header, MOST_PLAYERS, MOST_SCENE_BYTES, MOST_TICKS, Replay};
use crate::runs::Runs;

/// Most bytes of a replay: eight sticks that move in every tick of an hour at 30 Hz.
pub const MOST_BYTES: usize = 8 << 20;

const MAGIC: [u8; 4] = *b"PSRP";
const VERSION: u16 = 1;
const CHECKSUM_LEN: usize = 4;

/// Bytes of a replay of no ticks, but for the name of its scene: the fields before the pads, the last hash, the checksum.
const FRAME_LEN: usize = 4 + 2 + 2 + 8 + 4 + 1 + 1 + 4 + 8 + CHECKSUM_LEN;

/// The checksum at the end of a replay, of all bytes before it.
#[must_use]
pub fn checksum(bytes: &[u8]) -> u32 {
    let hash = StateHash::of(bytes);
    (hash ^ (hash >> 32)) as u32
}

/// Takes one value behind the other.
pub(crate) struct Reader<'a> {
    bytes: &'a [u8],
}

impl Reader<'_> {
    pub(crate) fn take<const N: usize>(&mut self, field: &'static str) -> Result<[u8; N], ReplayError> {
        let found = self.bytes.len();
        let (head, rest) =
            self.bytes.split_first_chunk().ok_or(ReplayError::Ends { field, expected: N, found })?;
        self.bytes = rest;
        Ok(*head)
    }

    fn need(&self, field: &'static str, expected: usize) -> Result<(), ReplayError> {
        let found = self.bytes.len();
        if found < expected { Err(ReplayError::Ends { field, expected, found }) } else { Ok(()) }
    }
}

impl Replay {
    /// Bytes of one of no ticks.
    pub(crate) fn empty_len(header: &Header) -> usize {
        FRAME_LEN + header.scene.len()
    }

    /// Its bytes, as [`Replay::from_bytes`] reads them. Equal replays have equal bytes.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut out = Vec::new();
        out.extend(MAGIC);
        out.extend(VERSION.to_le_bytes());
        out.extend(self.header.hash_every.to_le_bytes());
        out.extend(self.header.pack_hash.to_le_bytes());
        out.extend(self.header.seed.to_le_bytes());
        out.push(self.header.players);
        out.push(self.header.scene.len() as u8);
        out.extend(self.header.scene.as_bytes());
        out.extend(self.ticks.to_le_bytes());
        self.runs.iter().for_each(|runs| runs.write(&mut out));
        for hash in self.hashes.iter().chain([&self.last_hash]) {
            out.extend(hash.to_le_bytes());
        }
        out.extend(checksum(&out).to_le_bytes());
        out
    }

    /// Reads a replay.
    ///
    /// # Errors
    /// When the bytes are too many, damaged, of another version, or any field is out of its range. The message says what
    /// was expected and what was found.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, ReplayError> {
        if bytes.len() > MOST_BYTES {
            return Err(ReplayError::TooLong { most: MOST_BYTES, found: bytes.len() });
        }
        let mut reader = Reader { bytes };
        let found = reader.take("the first bytes")?;
        if found != MAGIC {
            return Err(ReplayError::Magic { expected: MAGIC, found });
        }
        let found = u16::from_le_bytes(reader.take("the version")?);
        if found != VERSION {
            return Err(ReplayError::Version { expected: VERSION, found });
        }
        let Some((body, [a, b, c, d])) =
            bytes.split_last_chunk::<CHECKSUM_LEN>().filter(|(body, _)| body.len() >= 6)
        else {
            return Err(ReplayError::Ends { field: "the checksum", expected: CHECKSUM_LEN, found: 0 });
        };
        let (expected, found) = (checksum(body), u32::from_le_bytes([*a, *b, *c, *d]));
        if expected != found {
            return Err(ReplayError::Checksum { expected, found });
        }
        Self::read(&mut Reader { bytes: &body[6..] })
    }

    fn read(reader: &mut Reader<'_>) -> Result<Self, ReplayError> {
        let hash_every = u16::from_le_bytes(reader.take("hash_every")?);
        let pack_hash = u64::from_le_bytes(reader.take("pack_hash")?);
        let seed = u32::from_le_bytes(reader.take("seed")?);
        let [players, scene_len] = reader.take("players")?;
        // Checked before anything is read by them; `Header::check` says the rest.
        if usize::from(scene_len) > MOST_SCENE_BYTES || usize::from(players) > MOST_PLAYERS {
            let (field, expected, found) = match usize::from(players) > MOST_PLAYERS {
                true => ("players", "1 to 8", players),
                false => ("scene", "1 to 64 characters", scene_len),
            };
            return Err(ReplayError::Field { field, expected, found: found.to_string() });
        }
        reader.need("scene", scene_len.into())?;
        let (scene, rest) = reader.bytes.split_at(scene_len.into());
        reader.bytes = rest;
        let scene = String::from_utf8_lossy(scene).into_owned();
        let header = Header { pack_hash, seed, hash_every, players, scene };
        header.check()?;
        let ticks = u32::from_le_bytes(reader.take("ticks")?);
        if ticks > MOST_TICKS {
            let expected = "at most 432000";
            return Err(ReplayError::Field { field: "ticks", expected, found: ticks.to_string() });
        }
        let runs =
            (0..players).map(|_| Runs::read(reader, ticks)).collect::<Result<Vec<_>, ReplayError>>()?;
        let count = (ticks / u32::from(header.hash_every)) as usize;
        reader.need("the hashes", 8 * (count + 1))?;
        let hash = |bytes: [u8; 8]| u64::from_le_bytes(bytes);
        let hashes = (0..count)
            .map(|_| reader.take("the hashes").map(hash))
            .collect::<Result<Vec<_>, ReplayError>>()?;
        let last_hash = reader.take("the hashes").map(hash)?;
        match reader.bytes.len() {
            0 => Ok(Self { header, ticks, runs, hashes, last_hash }),
            found => Err(ReplayError::Trailing { found }),
        }
    }
}
