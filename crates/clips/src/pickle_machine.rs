//! The stack machine that reads a pickle: one opcode after the other, nothing run, nothing recursive.

use super::pickle::{Id, Object};

/// Most objects in a file.
const MAX_OBJECTS: usize = 1 << 20;

/// Reads all objects of `bytes` and tells which is outermost.
pub(super) fn read(bytes: &[u8]) -> Result<(Vec<Object>, Id), String> {
    let mut machine =
        Machine { bytes, at: 0, objects: Vec::new(), stack: Vec::new(), marks: Vec::new(), memo: Vec::new() };
    let root = machine.run()?;
    Ok((machine.objects, root))
}

struct Machine<'a> {
    bytes: &'a [u8],
    at: usize,
    objects: Vec<Object>,
    stack: Vec<Id>,
    marks: Vec<usize>,
    memo: Vec<Option<Id>>,
}

type Step<T> = Result<T, String>;

impl Machine<'_> {
    fn take(&mut self, count: usize) -> Step<&[u8]> {
        let end = self.at.checked_add(count).filter(|e| *e <= self.bytes.len());
        let end =
            end.ok_or_else(|| format!("expected {count} bytes at {}, found the end of the file", self.at))?;
        // `end` is inside, and `at` is not behind it.
        let taken = &self.bytes[self.at..end];
        self.at = end;
        Ok(taken)
    }

    fn number(&mut self, bytes: usize) -> Step<u64> {
        let mut wide = [0; 8];
        // Callers ask for 1 to 8 bytes.
        wide[..bytes].copy_from_slice(self.take(bytes)?);
        Ok(u64::from_le_bytes(wide))
    }

    fn counted(&mut self, bytes: usize) -> Step<Vec<u8>> {
        let count =
            usize::try_from(self.number(bytes)?).map_err(|_| "expected a length that fits".to_owned())?;
        Ok(self.take(count)?.to_vec())
    }

    fn text(&mut self, bytes: usize) -> Step<String> {
        String::from_utf8(self.counted(bytes)?).map_err(|_| format!("expected UTF-8 before {}", self.at))
    }

    fn line(&mut self) -> Step<String> {
        // An opcode was just taken, so `at` is inside; a line leaves it there.
        let rest = &self.bytes[self.at..];
        let end = rest.iter().position(|b| *b == b'\n').ok_or("expected the end of a line")?;
        let line = String::from_utf8_lossy(&rest[..end]).into_owned();
        self.at += end + 1;
        Ok(line)
    }

    fn push(&mut self, object: Object) -> Step<()> {
        if self.objects.len() >= MAX_OBJECTS {
            return Err(format!("expected at most {MAX_OBJECTS} objects, found more"));
        }
        self.stack.push(self.objects.len());
        self.objects.push(object);
        Ok(())
    }

    fn pop(&mut self) -> Step<Id> {
        let floor = self.marks.last().copied().unwrap_or(0);
        if self.stack.len() <= floor {
            return Err(format!("expected an object before {}, found none", self.at));
        }
        self.stack.pop().ok_or_else(|| "expected an object, found none".into())
    }

    fn since_mark(&mut self) -> Step<Vec<Id>> {
        let mark =
            self.marks.pop().ok_or_else(|| format!("expected a mark before {}, found none", self.at))?;
        // `pop` never goes below the last mark.
        Ok(self.stack.split_off(mark))
    }

    fn remember(&mut self, slot: usize) -> Step<()> {
        let top = *self.stack.last().ok_or("expected an object to remember, found none")?;
        if slot > MAX_OBJECTS {
            return Err(format!("expected a memo slot up to {MAX_OBJECTS}, found {slot}"));
        }
        if self.memo.len() <= slot {
            self.memo.resize(slot + 1, None);
        }
        // The memo was just made long enough.
        self.memo[slot] = Some(top);
        Ok(())
    }

    fn recall(&mut self, slot: usize) -> Step<()> {
        let id =
            self.memo.get(slot).copied().flatten().ok_or_else(|| format!("memo slot {slot} is empty"))?;
        self.stack.push(id);
        Ok(())
    }

    fn tuple(&mut self, count: usize) -> Step<()> {
        let mut items = Vec::with_capacity(count);
        for _ in 0..count {
            items.push(self.pop()?);
        }
        items.reverse();
        self.push(Object::Sequence(items))
    }

    fn call(&mut self) -> Step<()> {
        let (arguments, what) = (self.pop()?, self.pop()?);
        self.push(Object::Call { what, arguments, state: None, items: Vec::new() })
    }

    fn append(&mut self, new: Vec<Id>) -> Step<()> {
        let to = *self.stack.last().ok_or("expected a list, found none")?;
        // Every number on the stack is that of an object that was pushed.
        match &mut self.objects[to] {
            Object::Sequence(items) => items.extend(new),
            other => return Err(format!("expected a list, found {other:?}")),
        }
        Ok(())
    }

    fn set(&mut self, new: &[Id]) -> Step<()> {
        let to = *self.stack.last().ok_or("expected a dictionary, found none")?;
        match &mut self.objects[to] {
            Object::Dict(items) | Object::Call { items, .. } => {
                items.extend(new.chunks_exact(2).map(|pair| (pair[0], pair[1])));
            }
            other => return Err(format!("expected a dictionary, found {other:?}")),
        }
        Ok(())
    }

    fn build(&mut self) -> Step<()> {
        let state_id = self.pop()?;
        let to = *self.stack.last().ok_or("expected an object to build, found none")?;
        if let Object::Call { state, .. } = &mut self.objects[to] {
            *state = Some(state_id);
        }
        Ok(())
    }

    fn run(&mut self) -> Step<Id> {
        loop {
            let code = self.take(1)?[0];
            match code {
                b'.' => return self.pop(),
                0x80 => self.at += 1,
                0x95 => self.at = self.at.saturating_add(8),
                b'(' => self.marks.push(self.stack.len()),
                b'0' => drop(self.pop()?),
                b'N' => self.push(Object::None)?,
                0x88 | 0x89 => self.push(Object::Bool(code == 0x88))?,
                b'K' | b'M' => {
                    let value = self.number(if code == b'K' { 1 } else { 2 })?;
                    self.push(Object::Int(value as i64))?;
                }
                b'J' => {
                    let value = self.number(4)? as u32 as i32;
                    self.push(Object::Int(value.into()))?;
                }
                0x8a => self.long()?,
                b'G' => {
                    let bits = self.number(8)?.swap_bytes();
                    self.push(Object::Float(f64::from_bits(bits)))?;
                }
                b'X' | 0x8c | 0x8d => {
                    let text = self.text(match code {
                        b'X' => 4,
                        0x8c => 1,
                        _ => 8,
                    })?;
                    self.push(Object::Text(text))?;
                }
                b'B' | b'C' | 0x8e | b'T' | b'U' => {
                    let bytes = self.counted(match code {
                        b'B' | b'T' => 4,
                        0x8e => 8,
                        _ => 1,
                    })?;
                    self.push(Object::Bytes(bytes))?;
                }
                b')' | b']' => self.push(Object::Sequence(Vec::new()))?,
                b'}' => self.push(Object::Dict(Vec::new()))?,
                0x85..=0x87 => self.tuple(usize::from(code) - 0x84)?,
                b't' | b'l' => {
                    let items = self.since_mark()?;
                    self.push(Object::Sequence(items))?;
                }
                b'a' => {
                    let item = self.pop()?;
                    self.append(vec![item])?;
                }
                b'e' => {
                    let items = self.since_mark()?;
                    self.append(items)?;
                }
                b's' => {
                    let (value, key) = (self.pop()?, self.pop()?);
                    self.set(&[key, value])?;
                }
                b'u' => {
                    let items = self.since_mark()?;
                    self.set(&items)?;
                }
                b'c' => {
                    let (module, name) = (self.line()?, self.line()?);
                    self.push(Object::Global(format!("{module}.{name}")))?;
                }
                0x93 => {
                    let (name, module) = (self.pop()?, self.pop()?);
                    let name = match (&self.objects[module], &self.objects[name]) {
                        (Object::Text(m), Object::Text(n)) => format!("{m}.{n}"),
                        _ => return Err("expected a module and a name".into()),
                    };
                    self.push(Object::Global(name))?;
                }
                b'R' | 0x81 => self.call()?,
                b'b' => self.build()?,
                b'q' | b'r' => {
                    let slot = self.number(if code == b'q' { 1 } else { 4 })?;
                    self.remember(slot as usize)?;
                }
                0x94 => self.remember(self.memo.len())?,
                b'h' | b'j' => {
                    let slot = self.number(if code == b'h' { 1 } else { 4 })?;
                    self.recall(slot as usize)?;
                }
                _ => return Err(format!("expected a known opcode at {}, found 0x{code:02x}", self.at - 1)),
            }
        }
    }

    fn long(&mut self) -> Step<()> {
        let bytes = self.counted(1)?;
        if bytes.len() > 8 {
            return Err(format!("expected a whole number of at most 8 bytes, found {}", bytes.len()));
        }
        let negative = bytes.last().is_some_and(|b| b & 0x80 != 0);
        let mut wide = [if negative { 0xff } else { 0 }; 8];
        wide[..bytes.len()].copy_from_slice(&bytes);
        self.push(Object::Int(i64::from_le_bytes(wide)))
    }
}
