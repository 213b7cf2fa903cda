//! The item state table: global and local items, and the fields that an input item adds.

use super::items::Item;
use super::{Descriptor, DescriptorError, Field, MAX_FIELDS, MAX_REPORT_BITS, Usage};

const MAX_DEPTH: usize = 32;
/// Most usages kept for one main item.
const MAX_USAGES: usize = 256;

#[derive(Clone, Copy, Default)]
struct Globals {
    page: u16,
    logical_min: i32,
    /// Signed and unsigned reading; the sign of the minimum decides between them.
    logical_max: (i32, u32),
    report_bits: u32,
    report_count: u32,
    report_id: u8,
}

/// Usages named before a main item, as ranges.
#[derive(Default)]
struct Locals {
    usages: Vec<(Usage, Usage)>,
    range_start: Option<Usage>,
}

impl Locals {
    /// The usage of the `index`-th value; the last usage applies to all further values.
    fn usage(&self, mut index: u32) -> Usage {
        for &(first, last) in &self.usages {
            // `apply_usage` keeps ranges that ascend on one page; `index` stays inside this one.
            let count = u32::from(last.number() - first.number()) + 1;
            if index < count {
                return Usage(first.0 + index);
            }
            index -= count;
        }
        self.usages.last().map_or_else(Usage::default, |range| range.1)
    }
}

#[derive(Default)]
pub(super) struct State {
    globals: Globals,
    stack: Vec<Globals>,
    locals: Locals,
    /// Usage of each open collection.
    collections: Vec<Usage>,
    fields: Vec<Field>,
    has_report_ids: bool,
    report_bits: Vec<(u8, u32)>,
}

impl State {
    pub(super) fn apply(&mut self, item: Item) -> Result<(), DescriptorError> {
        let nesting = DescriptorError::Nesting { offset: item.offset };
        let globals = &mut self.globals;
        match item.kind {
            0x04 => globals.page = item.unsigned() as u16,
            0x14 => globals.logical_min = item.signed(),
            0x24 => globals.logical_max = (item.signed(), item.unsigned()),
            0x74 => globals.report_bits = item.unsigned(),
            0x94 => globals.report_count = item.unsigned(),
            0x84 => {
                let found = item.unsigned();
                let id = u8::try_from(found).ok().filter(|&id| id > 0);
                globals.report_id = id.ok_or(DescriptorError::ReportId { offset: item.offset, found })?;
                self.has_report_ids = true;
            }
            0xa4 if self.stack.len() < MAX_DEPTH => self.stack.push(*globals),
            0xb4 => *globals = self.stack.pop().ok_or(nesting)?,
            0xa4 => return Err(nesting),
            0x08 | 0x18 | 0x28 => self.apply_usage(item),
            0xa0 => {
                if self.collections.len() == MAX_DEPTH {
                    return Err(nesting);
                }
                self.collections.push(self.locals.usage(0));
                self.locals = Locals::default();
            }
            0xc0 => {
                self.collections.pop().ok_or(nesting)?;
                self.locals = Locals::default();
            }
            0x80 => {
                self.input(item)?;
                self.locals = Locals::default();
            }
            // Output and feature.
            0x90 | 0xb0 => self.locals = Locals::default(),
            // Units, exponents, physical ranges, designators, strings, delimiters: not needed.
            _ => {}
        }
        Ok(())
    }

    pub(super) fn finish(self) -> Result<Descriptor, DescriptorError> {
        Ok(Descriptor {
            fields: self.fields,
            has_report_ids: self.has_report_ids,
            report_bits: self.report_bits,
        })
    }

    fn apply_usage(&mut self, item: Item) {
        let full = item.len == 4;
        let usage =
            if full { Usage(item.unsigned()) } else { Usage::new(self.globals.page, item.unsigned() as u16) };
        let range = match item.kind {
            0x08 => (usage, usage),
            0x18 => {
                self.locals.range_start = Some(usage);
                return;
            }
            _ => match self.locals.range_start.take() {
                Some(start) if start.page() == usage.page() && start <= usage => (start, usage),
                _ => return,
            },
        };
        if self.locals.usages.len() < MAX_USAGES {
            self.locals.usages.push(range);
        }
    }

    fn input(&mut self, item: Item) -> Result<(), DescriptorError> {
        const CONSTANT: u32 = 0x01;
        const VARIABLE: u32 = 0x02;
        let (offset, flags, globals) = (item.offset, item.unsigned(), self.globals);
        let total = u64::from(globals.report_bits) * u64::from(globals.report_count);
        let start = self.advance(total).ok_or(DescriptorError::ReportTooLong { offset })?;
        if flags & CONSTANT != 0 || self.locals.usages.is_empty() || total == 0 {
            return Ok(());
        }
        let bits = globals.report_bits;
        if bits > 32 {
            return Err(DescriptorError::FieldWidth { offset, found: bits });
        }
        let (min, max) = logical_range(&globals);
        if min > max {
            return Err(DescriptorError::Range { offset, min, max });
        }
        // `advance` bounded width times count, and neither is 0: the sums below stay small.
        if self.fields.len() + globals.report_count as usize > MAX_FIELDS {
            return Err(DescriptorError::TooManyFields { offset });
        }
        // Usages are not empty, checked above.
        let is_array = flags & VARIABLE == 0;
        for index in 0..globals.report_count {
            let usage = self.locals.usage(if is_array { 0 } else { index });
            self.fields.push(Field {
                report_id: globals.report_id,
                bit_offset: start + index * bits,
                bits,
                logical_min: min,
                logical_max: max,
                usage,
                last_usage: if is_array { self.locals.usages[0].1 } else { usage },
                is_array,
                application: self.collections.first().copied().unwrap_or_default(),
            });
        }
        Ok(())
    }

    /// Reserves `bits` in the current report. Returns their first bit, or `None` past the limit.
    fn advance(&mut self, bits: u64) -> Option<u32> {
        let id = self.globals.report_id;
        let index = self.report_bits.iter().position(|report| report.0 == id).unwrap_or_else(|| {
            self.report_bits.push((id, 0));
            self.report_bits.len() - 1
        });
        // `index` was found or just pushed.
        let used = &mut self.report_bits[index].1;
        let start = *used;
        *used = u32::try_from(u64::from(start) + bits).ok().filter(|&end| end <= MAX_REPORT_BITS)?;
        Some(start)
    }
}

/// Many descriptors store the greatest value of an unsigned range in as few bytes as an unsigned number needs.
fn logical_range(globals: &Globals) -> (i32, i32) {
    let (signed, unsigned) = globals.logical_max;
    let max = if globals.logical_min < 0 || signed >= globals.logical_min {
        signed
    } else {
        i32::try_from(unsigned).unwrap_or(i32::MAX)
    };
    (globals.logical_min, max)
}
