//! The pads of one player, run-length coded: how many ticks, then what differs from the pad before.

use crate::bytes::Reader;
use crate::error::ReplayError;
use crate::pad::Pad;

/// So many ticks of one pad.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Run {
    pub(crate) ticks: u32,
    pub(crate) pad: Pad,
}

/// The pads of one player over time. Neighbours differ.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Runs(pub(crate) Vec<Run>);

/// Bits of a run's mask: which fields follow.
const STICK_X: u8 = 1;
const STICK_Y: u8 = 2;
const LEFT_TRIGGER: u8 = 4;
const RIGHT_TRIGGER: u8 = 8;
const CAMERA: u8 = 16;
const BUTTONS: u8 = 32;
const ALL: u8 = 63;

/// Where in a replay an error is.
const WHERE: &str = "the pads";

impl Runs {
    /// Adds the pad of one more tick.
    pub(crate) fn push(&mut self, pad: Pad) {
        match self.0.last_mut() {
            Some(run) if run.pad == pad => run.ticks += 1,
            _ => self.0.push(Run { ticks: 1, pad }),
        }
    }

    /// Bytes that a pad of one more tick adds.
    pub(crate) fn grows_by(&self, pad: Pad) -> usize {
        match self.0.last() {
            Some(run) if run.pad == pad => varint_len(run.ticks + 1) - varint_len(run.ticks),
            last => run_len(1, last.map_or(Pad::default(), |run| run.pad), pad),
        }
    }

    /// Appends its bytes.
    pub(crate) fn write(&self, out: &mut Vec<u8>) {
        let mut last = Pad::default();
        for &Run { ticks, pad } in &self.0 {
            varint(ticks, out);
            let mask = mask(last, pad);
            out.push(mask);
            let bytes = pad.to_bytes();
            for (index, bit) in [STICK_X, STICK_Y, LEFT_TRIGGER, RIGHT_TRIGGER].into_iter().enumerate() {
                if mask & bit != 0 {
                    out.push(bytes[index]);
                }
            }
            if mask & CAMERA != 0 {
                out.extend(&bytes[4..6]);
            }
            if mask & BUTTONS != 0 {
                varint(pad.buttons, out);
            }
            last = pad;
        }
    }

    /// Reads the runs of exactly so many ticks. Allocates in step with the bytes that are there.
    ///
    /// # Errors
    /// When the bytes end, a run is of no ticks or of too many, a mask is unknown, or two neighbours are the same pad.
    pub(crate) fn read(reader: &mut Reader<'_>, ticks: u32) -> Result<Self, ReplayError> {
        let mut runs = Self::default();
        let (mut left, mut last) = (ticks, Pad::default());
        while left > 0 {
            let found = read_varint(reader)?;
            if !(1..=left).contains(&found) {
                return Err(wrong("a run of 1 to as many ticks as are left", found));
            }
            let [mask] = reader.take(WHERE)?;
            if mask & !ALL != 0 {
                return Err(wrong("a mask of the six fields of a pad", mask.into()));
            }
            let mut bytes = last.to_bytes();
            for (index, bit) in [STICK_X, STICK_Y, LEFT_TRIGGER, RIGHT_TRIGGER].into_iter().enumerate() {
                if mask & bit != 0 {
                    [bytes[index]] = reader.take(WHERE)?;
                }
            }
            if mask & CAMERA != 0 {
                bytes[4..6].copy_from_slice(&reader.take::<2>(WHERE)?);
            }
            if mask & BUTTONS != 0 {
                bytes[6..].copy_from_slice(&read_varint(reader)?.to_le_bytes());
            }
            let pad = Pad::from_bytes(bytes);
            if pad == last && !runs.0.is_empty() {
                return Err(wrong("a pad that differs from the one before", mask.into()));
            }
            runs.0.push(Run { ticks: found, pad });
            (left, last) = (left - found, pad);
        }
        Ok(runs)
    }
}

/// Which fields of a pad differ from those of the pad before.
fn mask(last: Pad, pad: Pad) -> u8 {
    let changed = [
        (STICK_X, pad.left_stick[0] != last.left_stick[0]),
        (STICK_Y, pad.left_stick[1] != last.left_stick[1]),
        (LEFT_TRIGGER, pad.triggers[0] != last.triggers[0]),
        (RIGHT_TRIGGER, pad.triggers[1] != last.triggers[1]),
        (CAMERA, pad.camera != last.camera),
        (BUTTONS, pad.buttons != last.buttons),
    ];
    changed.iter().filter(|(_, differs)| *differs).fold(0, |mask, (bit, _)| mask | bit)
}

/// Bytes of a run of a pad behind another.
fn run_len(ticks: u32, last: Pad, pad: Pad) -> usize {
    let mask = mask(last, pad);
    let one = (mask & (STICK_X | STICK_Y | LEFT_TRIGGER | RIGHT_TRIGGER)).count_ones() as usize;
    let camera = if mask & CAMERA != 0 { 2 } else { 0 };
    let buttons = if mask & BUTTONS != 0 { varint_len(pad.buttons) } else { 0 };
    varint_len(ticks) + 1 + one + camera + buttons
}

/// Bytes of a number by [`varint`].
fn varint_len(value: u32) -> usize {
    (value.max(1).ilog2() / 7) as usize + 1
}

/// Seven bits a byte, low ones first; the top bit says that more follow.
fn varint(mut value: u32, out: &mut Vec<u8>) {
    while value >= 0x80 {
        out.push((value as u8 & 0x7f) | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}

fn read_varint(reader: &mut Reader<'_>) -> Result<u32, ReplayError> {
    let mut value = 0u64;
    for shift in (0..35).step_by(7) {
        let [byte] = reader.take(WHERE)?;
        value |= u64::from(byte & 0x7f) << shift;
        if byte & 0x80 == 0 {
            return u32::try_from(value).map_err(|_| wrong("a number of 32 bits", u32::MAX));
        }
    }
    Err(wrong("a number of at most five bytes", u32::MAX))
}

fn wrong(expected: &'static str, found: u32) -> ReplayError {
    ReplayError::Field { field: WHERE, expected, found: found.to_string() }
}
