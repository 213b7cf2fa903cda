//! Handles that stay valid while other things come and go, and that fail once their own thing is gone.

use std::hash::{Hash, Hasher};
use std::marker::PhantomData;

use policy_core::contract::{Fixture, Joint, Prop};

use crate::description::model::Model;
use crate::description::world_error::WorldError;

/// Names one thing in a [`World`](crate::World). `K` is what it was made of.
pub struct Handle<K> {
    index: u32,
    generation: u32,
    kind: PhantomData<fn() -> K>,
}

/// Names a character.
pub type CharacterHandle = Handle<Model>;
/// Names a prop.
pub type PropHandle = Handle<Prop>;
/// Names a fixture.
pub type FixtureHandle = Handle<Fixture>;
/// Names a joint.
pub type JointHandle = Handle<Joint>;
/// Names a grab.
pub type GrabHandle = Handle<super::forces::Grab>;

impl<K> Handle<K> {
    pub(super) fn new(index: usize, generation: u32) -> Self {
        let index = u32::try_from(index).expect("far fewer than 2^32 things");
        Self { index, generation, kind: PhantomData }
    }

    /// A small number, unique among what is in the world now: for tables of a game's own.
    #[must_use]
    pub fn index(self) -> usize {
        self.index as usize
    }

    pub(super) fn generation(self) -> u32 {
        self.generation
    }
}

impl<K> Clone for Handle<K> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<K> Copy for Handle<K> {}

impl<K> PartialEq for Handle<K> {
    fn eq(&self, other: &Self) -> bool {
        (self.index, self.generation) == (other.index, other.generation)
    }
}

impl<K> Eq for Handle<K> {}

impl<K> Hash for Handle<K> {
    fn hash<H: Hasher>(&self, state: &mut H) {
        (self.index, self.generation).hash(state);
    }
}

impl<K> std::fmt::Debug for Handle<K> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Handle({}, {})", self.index, self.generation)
    }
}

/// A thing, with the generation that its handles have.
#[derive(Clone, Debug)]
pub(super) struct Slot<T> {
    pub generation: u32,
    /// False for what is compiled and kept aside.
    pub present: bool,
    pub value: T,
}

/// Things by index. An index is used again, a generation never.
#[derive(Clone, Debug)]
pub(super) struct Slots<T> {
    what: &'static str,
    slots: Vec<Option<Slot<T>>>,
}

impl<T> Slots<T> {
    pub(super) fn new(what: &'static str) -> Self {
        Self { what, slots: Vec::new() }
    }

    /// Puts `value` into the first free slot. Returns the index.
    pub(super) fn insert(&mut self, generation: u32, present: bool, value: T) -> usize {
        let slot = Some(Slot { generation, present, value });
        if let Some(index) = self.slots.iter().position(Option::is_none) {
            self.slots[index] = slot;
            return index;
        }
        self.slots.push(slot);
        self.slots.len() - 1
    }

    pub(super) fn clear(&mut self, index: usize) {
        self.slots[index] = None;
    }

    /// The index of what a handle names.
    pub(super) fn index_of<K>(&self, handle: Handle<K>) -> Result<usize, WorldError> {
        let slot = self.slots.get(handle.index()).and_then(Option::as_ref);
        match slot {
            Some(slot) if slot.present && slot.generation == handle.generation() => Ok(handle.index()),
            _ => Err(WorldError::Stale { what: self.what }),
        }
    }

    pub(super) fn slot(&self, index: usize) -> Option<&Slot<T>> {
        self.slots.get(index)?.as_ref()
    }

    pub(super) fn slot_mut(&mut self, index: usize) -> Option<&mut Slot<T>> {
        self.slots.get_mut(index)?.as_mut()
    }

    /// What is at an index that [`Slots::index_of`] returned.
    pub(super) fn at(&self, index: usize) -> &T {
        &self.slots[index].as_ref().expect("a slot that is in use").value
    }

    pub(super) fn at_mut(&mut self, index: usize) -> &mut T {
        &mut self.slots[index].as_mut().expect("a slot that is in use").value
    }

    pub(super) fn handle<K>(&self, index: usize) -> Handle<K> {
        Handle::new(index, self.slots[index].as_ref().map_or(0, |slot| slot.generation))
    }

    /// All that is compiled, with its index.
    pub(super) fn iter(&self) -> impl Iterator<Item = (usize, &Slot<T>)> {
        self.slots.iter().enumerate().filter_map(|(index, slot)| Some((index, slot.as_ref()?)))
    }

    /// All that is in the world, with its index.
    pub(super) fn present(&self) -> impl Iterator<Item = (usize, &T)> {
        self.iter().filter(|(_, slot)| slot.present).map(|(index, slot)| (index, &slot.value))
    }

    /// One more than the highest index.
    pub(super) fn end(&self) -> usize {
        self.slots.len()
    }
}
