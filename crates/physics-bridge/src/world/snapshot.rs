//! The whole state of a world, to return to: it continues from there bit for bit.

use super::World;
use super::forces::Forces;
use super::handle::{Slot, Slots};
use super::recover::Standing;
use crate::StateHash;
use crate::description::model::STATE;
use crate::ring::{MOST_SECS, NotRecorded, Ring};

/// State of a [`World`] at the end of a control tick: of every character and prop, forces under way, and what is
/// present. Not in it: the shapes of what is in the world. It fits worlds in which the same things were added, in the
/// same order, since the last build.
#[derive(Clone, Debug, PartialEq)]
pub struct WorldSnapshot {
    layout: u64,
    state: Box<[f64]>,
    tick: u64,
    forces: Forces,
    props: Box<[Presence]>,
    characters: Box<[Presence]>,
    standing: Box<[Standing]>,
}

/// The generation of a slot, and whether what is in it is in the world.
type Presence = (u32, bool);

/// The world was built with other things in it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "expected a snapshot of the layout {expected:016x}, found one of {found:016x}: things were added since"
)]
#[non_exhaustive]
pub struct LayoutMismatch {
    /// The layout of the world.
    pub expected: u64,
    /// That of the snapshot.
    pub found: u64,
}

impl WorldSnapshot {
    /// Room for the state of a world; fill it before restoring it.
    pub(super) fn empty(world: &World) -> Self {
        Self {
            layout: world.places.hash,
            state: vec![0.0; world.data.model().state_size(STATE)].into(),
            tick: 0,
            forces: Forces::new(world.places.owners.len()),
            props: vec![(0, false); world.scene.props.end()].into(),
            characters: vec![(0, false); world.scene.characters.end()].into(),
            standing: vec![Standing::default(); world.scene.characters.end()].into(),
        }
    }

    /// Control ticks that the world had completed.
    #[must_use]
    pub fn tick(&self) -> u64 {
        self.tick
    }

    /// The [`StateHash`] of the state and the tick: the same for the same state, bit for bit.
    #[must_use]
    pub fn hash(&self) -> u64 {
        StateHash::of_state(&self.state, self.tick)
    }

    fn fits(&self, world: &World) -> bool {
        self.layout == world.places.hash
            && self.state.len() == world.data.model().state_size(STATE)
            && self.props.len() == world.scene.props.end()
            && self.characters.len() == world.scene.characters.end()
    }

    /// Overwrites this with the state of a world that it fits. Does not allocate.
    pub(super) fn record(&mut self, world: &World) {
        world.data.read_state_into(STATE, &mut self.state);
        self.tick = world.tick;
        self.forces.copy_from(&world.forces);
        read_presence(&world.scene.props, &mut self.props);
        read_presence(&world.scene.characters, &mut self.characters);
        self.standing.copy_from_slice(&world.standing);
    }
}

fn read_presence<T>(slots: &Slots<T>, out: &mut [Presence]) {
    for (index, slot) in slots.iter() {
        out[index] = (slot.generation, slot.present);
    }
}

/// Takes over what is present. Returns whether it was otherwise before.
fn write_presence<T>(slot: Option<&mut Slot<T>>, &(generation, present): &Presence) -> bool {
    let Some(slot) = slot else { return false };
    let changed = slot.present != present;
    (slot.generation, slot.present) = (generation, present);
    changed
}

impl World {
    /// The state now. Allocates.
    #[must_use]
    pub fn save(&self) -> WorldSnapshot {
        let mut snapshot = WorldSnapshot::empty(self);
        snapshot.record(self);
        snapshot
    }

    /// Overwrites `out` with the state now. Allocates only when the world was built anew since.
    pub fn save_into(&self, out: &mut WorldSnapshot) {
        if out.fits(self) {
            out.record(self);
        } else {
            *out = self.save();
        }
    }

    /// Returns to a saved state and continues from there bit for bit. Handles are valid again if they were then. The
    /// recorded history ends; it starts again with this state.
    ///
    /// # Errors
    /// When the world was built anew since; it is then unchanged.
    pub fn restore(&mut self, snapshot: &WorldSnapshot) -> Result<(), LayoutMismatch> {
        if !snapshot.fits(self) {
            return Err(LayoutMismatch { expected: self.places.hash, found: snapshot.layout });
        }
        self.load(snapshot);
        self.restart_history();
        Ok(())
    }

    /// Returns to a state that fits and leaves the history as it is.
    pub(super) fn load(&mut self, snapshot: &WorldSnapshot) {
        self.load_state(snapshot);
        self.refresh();
    }

    /// As [`World::load`], without computing what is derived from the state.
    pub(super) fn load_state(&mut self, snapshot: &WorldSnapshot) {
        self.clear_warnings();
        self.data
            .set_state(&snapshot.state, STATE)
            .expect("the length was checked, and no model has a history of delays");
        self.tick = snapshot.tick;
        self.forces.copy_from(&snapshot.forces);
        self.standing.copy_from_slice(&snapshot.standing);
        for (index, presence) in snapshot.props.iter().enumerate() {
            if write_presence(self.scene.props.slot_mut(index), presence) {
                self.show_prop(index, presence.1);
            }
        }
        for (index, presence) in snapshot.characters.iter().enumerate() {
            if write_presence(self.scene.characters.slot_mut(index), presence) {
                self.show_character(index, presence.1);
            }
        }
    }
}

impl World {
    /// Keeps the states of the last `secs` seconds from now on. Allocates them here, and again when something is
    /// added, which forgets them. Forgets a history that was recorded before.
    pub fn record_history(&mut self, secs: f32) {
        let secs = secs.clamp(0.0, MOST_SECS);
        let ticks = (secs * self.ground.control_hz()).round() as usize;
        self.history = Some(Box::new(Ring::new(ticks + 1, || WorldSnapshot::empty(self))));
        self.restart_history();
    }

    /// States recorded, the present one included; 0 when none is recorded.
    #[must_use]
    pub fn history_len(&self) -> usize {
        self.history.as_ref().map_or(0, |history| history.len())
    }

    /// How many ticks before the newest recorded state the world is: 0 unless it was rewound.
    #[must_use]
    pub fn history_age(&self) -> usize {
        self.history.as_ref().map_or(0, |history| history.age())
    }

    /// Goes to the state `age` ticks before the newest recorded one. Newer states stay recorded until the next
    /// [`World::step`], which repeats the first one bit for bit if the characters get the same targets.
    ///
    /// # Errors
    /// When that many are not recorded; the world is then unchanged.
    pub fn rewind_to(&mut self, age: usize) -> Result<(), NotRecorded> {
        let missing = NotRecorded { asked: age, recorded: self.history_len() };
        let Some(mut history) = self.history.take() else { return Err(missing) };
        let found = history.at_age(age).map(|snapshot| self.load(snapshot));
        if found.is_some() {
            history.set_age(age);
        }
        self.history = Some(history);
        found.ok_or(missing)
    }

    /// Records the present state as the next one.
    pub(super) fn record(&mut self) {
        if let Some(mut history) = self.history.take() {
            history.next_slot().record(self);
            self.history = Some(history);
        }
    }

    /// Forgets the recorded states and records the present one, if a history is recorded at all.
    pub(super) fn restart_history(&mut self) {
        if let Some(history) = &mut self.history {
            history.clear();
            self.record();
        }
    }

    /// As [`World::restart_history`], after the world was built anew.
    pub(super) fn rebuild_history(&mut self) {
        if let Some(history) = &self.history {
            let capacity = history.capacity();
            self.history = Some(Box::new(Ring::new(capacity, || WorldSnapshot::empty(self))));
            self.restart_history();
        }
    }
}
