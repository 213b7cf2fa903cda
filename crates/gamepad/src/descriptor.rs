//! HID report descriptors: which bits of which input report mean what.
//!
//! Keeps input fields only. Every loop is bounded by the length of the descriptor and the limits below, for any
//! bytes. Source: *Device Class Definition for Human Interface Devices 1.11*, section 6.2.2.

mod items;
mod state;

use items::Items;
use state::State;

/// Longest descriptor accepted, in bytes (the kernel's limit).
pub const MAX_DESCRIPTOR_BYTES: usize = 4096;
/// Most input fields kept.
pub const MAX_FIELDS: usize = 1024;
/// Longest input report that a descriptor may describe, in bits.
pub const MAX_REPORT_BITS: u32 = 8 * 4096;

/// A usage: page in the upper half, number in the lower half, as in the HID Usage Tables.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Usage(pub u32);

impl Usage {
    /// The usage `number` on `page`.
    #[must_use]
    pub const fn new(page: u16, number: u16) -> Self {
        Self((page as u32) << 16 | number as u32)
    }

    /// Upper half.
    #[must_use]
    pub const fn page(self) -> u16 {
        (self.0 >> 16) as u16
    }

    /// Lower half.
    #[must_use]
    pub const fn number(self) -> u16 {
        self.0 as u16
    }
}

/// One value in an input report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field {
    /// Report it is in; 0 for a device without report ids.
    pub report_id: u8,
    /// First bit, counted from the start of the report without its id.
    pub bit_offset: u32,
    /// Width in bits, [1, 32].
    pub bits: u32,
    /// Least value.
    pub logical_min: i32,
    /// Greatest value, at least `logical_min`.
    pub logical_max: i32,
    /// What the value means. For an array: the usage of `logical_min`.
    pub usage: Usage,
    /// For an array: the usage of `logical_max`; else the same as `usage`.
    pub last_usage: Usage,
    /// True when the value selects one of several usages; false when it measures one.
    pub is_array: bool,
    /// Usage of the outermost collection, e.g. Game Pad.
    pub application: Usage,
}

impl Field {
    /// The value in `report` (without its id); `None` when the report is too short.
    #[must_use]
    pub fn value(&self, report: &[u8]) -> Option<i32> {
        // A descriptor's fields end by MAX_REPORT_BITS and have 1 to 32 bits, which touch at most 5 bytes.
        let end = (self.bit_offset + self.bits).div_ceil(8) as usize;
        let bytes = report.get(self.bit_offset as usize / 8..end)?;
        let mut window = [0; 8];
        window[..bytes.len()].copy_from_slice(bytes);
        let unsigned = (u64::from_le_bytes(window) >> (self.bit_offset % 8)) as u32;
        let unused = 32 - self.bits;
        let left = unsigned << unused;
        Some(if self.logical_min < 0 { left as i32 >> unused } else { (left >> unused) as i32 })
    }

    /// The value as a fraction of its range in [0, 1]; clamped.
    #[must_use]
    pub fn fraction(&self, value: i32) -> f32 {
        let (low, high) = (f64::from(self.logical_min), f64::from(self.logical_max));
        (((f64::from(value) - low) / (high - low).max(1.0)) as f32).clamp(0.0, 1.0)
    }
}

/// The input fields of a device, in the order of the descriptor.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Descriptor {
    /// Every input field except padding.
    pub fields: Vec<Field>,
    /// Reports start with an id.
    pub has_report_ids: bool,
    /// Length in bits of each input report, without its id, by id.
    pub report_bits: Vec<(u8, u32)>,
}

impl Descriptor {
    /// Reads a report descriptor. At most [`MAX_DESCRIPTOR_BYTES`] bytes and [`MAX_FIELDS`] fields.
    ///
    /// # Errors
    /// [`DescriptorError`] with the offset of the invalid item.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, DescriptorError> {
        if bytes.len() > MAX_DESCRIPTOR_BYTES {
            return Err(DescriptorError::TooLong { found: bytes.len() });
        }
        let mut state = State::default();
        for item in Items::new(bytes) {
            state.apply(item?)?;
        }
        state.finish()
    }
}

/// Why a report descriptor was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DescriptorError {
    /// The descriptor is too long.
    #[error("expected at most {MAX_DESCRIPTOR_BYTES} bytes, found {found}")]
    TooLong {
        /// Bytes found.
        found: usize,
    },
    /// The last item is shorter than its first byte says.
    #[error("item at byte {offset}: expected {expected} bytes of data, found {found}")]
    Truncated {
        /// Where the item starts.
        offset: usize,
        /// Bytes of data the item says it has.
        expected: usize,
        /// Bytes left.
        found: usize,
    },
    /// A field is wider than 32 bits or has no width.
    #[error("item at byte {offset}: expected a field of 1 to 32 bits, found {found}")]
    FieldWidth {
        /// Where the item starts.
        offset: usize,
        /// Width found.
        found: u32,
    },
    /// A minimum is above its maximum.
    #[error("item at byte {offset}: expected a logical range, found {min} to {max}")]
    Range {
        /// Where the item starts.
        offset: usize,
        /// Logical minimum.
        min: i32,
        /// Logical maximum.
        max: i32,
    },
    /// There are more fields than [`MAX_FIELDS`].
    #[error("item at byte {offset}: expected at most {MAX_FIELDS} fields, found more")]
    TooManyFields {
        /// Where the item starts.
        offset: usize,
    },
    /// A report is longer than [`MAX_REPORT_BITS`].
    #[error("item at byte {offset}: expected a report of at most {MAX_REPORT_BITS} bits, found more")]
    ReportTooLong {
        /// Where the item starts.
        offset: usize,
    },
    /// A report id is 0 or does not fit a byte.
    #[error("item at byte {offset}: expected a report id from 1 to 255, found {found}")]
    ReportId {
        /// Where the item starts.
        offset: usize,
        /// Id found.
        found: u32,
    },
    /// Push, pop or collections do not match or are nested too deep.
    #[error("item at byte {offset}: expected matching push and pop and collections, at most 32 deep")]
    Nesting {
        /// Where the item starts.
        offset: usize,
    },
}
