//! A hash of a simulation's state.

/// FNV-1a of 64 bits. It finds states that differ by accident; it protects from nobody.
///
/// ```
/// use replay::StateHash;
/// let mut hash = StateHash::new();
/// hash.bytes(b"a");
/// assert_eq!(hash.value(), 0xaf63_dc4c_8601_ec8c);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StateHash(u64);

const START: u64 = 0xcbf2_9ce4_8422_2325;
const PRIME: u64 = 0x0100_0000_01b3;

impl StateHash {
    /// The hash of nothing.
    #[must_use]
    pub const fn new() -> Self {
        Self(START)
    }

    /// Adds bytes.
    pub fn bytes(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(PRIME);
        }
    }

    /// Adds 32 bits in one step: four times as quick as their bytes, and another value than theirs.
    pub fn word(&mut self, bits: u32) {
        self.0 = (self.0 ^ u64::from(bits)).wrapping_mul(PRIME);
        // The product moves bits up only; this brings them down again.
        self.0 ^= self.0 >> 32;
    }

    /// Adds the bits of numbers. Both zeros count as different, and so do two NaNs of other bits.
    pub fn floats(&mut self, values: &[f32]) {
        values.iter().for_each(|value| self.word(value.to_bits()));
    }

    /// The hash so far.
    #[must_use]
    pub const fn value(self) -> u64 {
        self.0
    }

    /// The hash of some bytes, such as those of a pack.
    #[must_use]
    pub fn of(bytes: &[u8]) -> u64 {
        let mut hash = Self::new();
        hash.bytes(bytes);
        hash.value()
    }
}

impl Default for StateHash {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_values_are_met() {
        assert_eq!(StateHash::of(b""), START);
        assert_eq!(StateHash::of(b"foobar"), 0x8594_4171_f739_67e8);
    }

    #[test]
    fn every_bit_and_every_place_counts() {
        let of = |values: &[f32]| {
            let mut hash = StateHash::new();
            hash.floats(values);
            hash.value()
        };
        let one = of(&[1.0, 2.0]);
        for bit in 0..32 {
            assert_ne!(of(&[f32::from_bits(1.0f32.to_bits() ^ (1 << bit)), 2.0]), one, "bit {bit}");
        }
        assert_ne!(of(&[2.0, 1.0]), one);
        assert_ne!(of(&[0.0]), of(&[-0.0]));
    }
}
