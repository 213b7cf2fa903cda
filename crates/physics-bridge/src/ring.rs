//! The last states of something, all allocated at the start, to step back through.

/// Longest history, seconds: about 250 MB for the humanoid.
pub(crate) const MOST_SECS: f32 = 3600.0;

/// No such state is recorded.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("expected to go back fewer than {recorded} recorded ticks, found {asked}")]
#[non_exhaustive]
pub struct NotRecorded {
    /// How far back was asked for, ticks.
    pub asked: usize,
    /// States recorded, the newest included; 0 when nothing is.
    pub recorded: usize,
}

/// A ring of states.
#[derive(Debug)]
pub(crate) struct Ring<S> {
    slots: Box<[S]>,
    /// Slot of the newest state.
    newest: usize,
    /// States recorded.
    len: usize,
    /// How many states before the newest the present one is.
    age: usize,
}

impl<S> Ring<S> {
    /// Room for so many states, at least one, each made by `empty`. Allocates.
    pub(crate) fn new(capacity: usize, empty: impl FnMut() -> S) -> Self {
        let slots = std::iter::repeat_with(empty).take(capacity.max(1)).collect();
        Self { slots, newest: 0, len: 0, age: 0 }
    }

    /// The slot for the state that follows the present one; what came after that is forgotten.
    pub(crate) fn next_slot(&mut self) -> &mut S {
        let capacity = self.slots.len();
        self.newest = (self.newest + capacity - self.age + 1) % capacity;
        self.len = (self.len - self.age + 1).min(capacity);
        self.age = 0;
        &mut self.slots[self.newest]
    }

    /// The state so many before the newest.
    pub(crate) fn at_age(&self, age: usize) -> Option<&S> {
        (age < self.len).then(|| &self.slots[(self.newest + self.slots.len() - age) % self.slots.len()])
    }

    /// Forgets all states.
    pub(crate) fn clear(&mut self) {
        (self.len, self.age) = (0, 0);
    }

    /// States recorded.
    pub(crate) fn len(&self) -> usize {
        self.len
    }

    /// How many states before the newest the present one is.
    pub(crate) fn age(&self) -> usize {
        self.age
    }

    /// Makes the state so many before the newest, which is recorded, the present one.
    pub(crate) fn set_age(&mut self, age: usize) {
        self.age = age;
    }

    /// States that it has room for.
    pub(crate) fn capacity(&self) -> usize {
        self.slots.len()
    }
}
