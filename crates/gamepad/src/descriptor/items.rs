//! Iterates over the items of a report descriptor.

use super::DescriptorError;

/// One item: type and tag as in its first byte, and its data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Item {
    pub(super) offset: usize,
    /// First byte without the length bits.
    pub(super) kind: u8,
    pub(super) len: usize,
    pub(super) data: [u8; 4],
}

impl Item {
    pub(super) fn unsigned(self) -> u32 {
        u32::from_le_bytes(self.data)
    }

    pub(super) fn signed(self) -> i32 {
        match self.len {
            0 => 0,
            1 => i8::from_le_bytes([self.data[0]]).into(),
            2 => i16::from_le_bytes([self.data[0], self.data[1]]).into(),
            _ => i32::from_le_bytes(self.data),
        }
    }
}

/// Iterates over the short items; skips long items.
pub(super) struct Items<'a> {
    bytes: &'a [u8],
    offset: usize,
}

impl<'a> Items<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, offset: 0 }
    }

    fn take(&mut self, start: usize, len: usize) -> Result<&'a [u8], DescriptorError> {
        // `offset` never passes the end, and a descriptor is at most 4096 bytes long.
        let left = self.bytes.len() - self.offset;
        let Some(data) = self.bytes.get(self.offset..self.offset + len) else {
            self.offset = self.bytes.len();
            return Err(DescriptorError::Truncated { offset: start, expected: len, found: left });
        };
        self.offset += len;
        Ok(data)
    }
}

impl Iterator for Items<'_> {
    type Item = Result<Item, DescriptorError>;

    fn next(&mut self) -> Option<Self::Item> {
        const LONG: u8 = 0xfe;
        loop {
            let offset = self.offset;
            let first = *self.bytes.get(offset)?;
            self.offset += 1;
            if first == LONG {
                // `take` gives as many bytes as asked for, here and below.
                let passed = self.take(offset, 2).map(|head| usize::from(head[0]));
                if let Err(error) = passed.and_then(|len| self.take(offset, len)) {
                    return Some(Err(error));
                }
                continue;
            }
            let len = [0, 1, 2, 4][usize::from(first & 0x03)];
            return Some(self.take(offset, len).map(|found| {
                let mut data = [0; 4];
                data[..len].copy_from_slice(found);
                Item { offset, kind: first & !0x03, len, data }
            }));
        }
    }
}
