//! The last seconds of a controller, kept beside those of its character's physics, so that both go back together and
//! continue bit for bit.

use glam::Vec2;
use physics_bridge::HISTORY_SECS;
use policy_core::{CharacterPack, ControllerState, GamepadState};

/// All of a steered character that the next tick depends on, besides its physics.
#[derive(Clone, Debug)]
pub(super) struct SavedTick {
    pub(super) controller: ControllerState,
    pub(super) down_secs: f32,
    pub(super) shoved_secs: f32,
    pub(super) was_down: bool,
    pub(super) falls: u32,
    pub(super) place: Option<Vec2>,
}

impl SavedTick {
    pub(super) fn new(pack: &CharacterPack) -> Self {
        let controller = ControllerState::new(pack);
        Self { controller, down_secs: 0.0, shoved_secs: 0.0, was_down: false, falls: 0, place: None }
    }
}

/// A ring of values, one for each tick, all allocated at the start. It moves as the history of the physics does.
#[derive(Clone, Debug)]
pub(super) struct Ring<T> {
    slots: Box<[T]>,
    newest: usize,
    len: usize,
    /// How many ticks before the newest it was taken back.
    age: usize,
}

impl<T: Clone> Ring<T> {
    /// Room for as many ticks as a character keeps, filled with `empty`.
    pub(super) fn new(control_hz: f32, empty: &T) -> Self {
        let ticks = (HISTORY_SECS * control_hz).round() as usize;
        Self { slots: vec![empty.clone(); ticks + 1].into(), newest: 0, len: 0, age: 0 }
    }

    /// The slot of the tick that follows the present one. What came after that is forgotten.
    pub(super) fn next(&mut self) -> &mut T {
        let capacity = self.slots.len();
        let kept = self.len - self.age;
        self.newest = (self.newest + capacity - self.age + 1) % capacity;
        (self.len, self.age) = ((kept + 1).min(capacity), 0);
        &mut self.slots[self.newest]
    }

    /// Forgets all ticks. The next slot is the first.
    pub(super) fn clear(&mut self) {
        (self.len, self.age) = (0, 0);
    }

    /// Goes `age` ticks back from the newest; `None` when that is not kept.
    pub(super) fn rewind_to(&mut self, age: usize) -> Option<&T> {
        if age >= self.len {
            return None;
        }
        self.age = age;
        Some(&self.slots[(self.newest + self.slots.len() - age) % self.slots.len()])
    }
}

/// The pad of each tick, because buttons act when they go down.
pub(super) type PadRing = Ring<GamepadState>;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_goes_back_and_on_as_the_physics_does() {
        let mut ring = Ring::new(30.0, &0);
        let at = |ring: &mut Ring<i32>, age| ring.rewind_to(age).copied();
        for tick in 0..400 {
            *ring.next() = tick;
        }
        assert_eq!((at(&mut ring, 0), at(&mut ring, 300), at(&mut ring, 301)), (Some(399), Some(99), None));
        // From ten ticks ago on, other ticks follow.
        assert_eq!(at(&mut ring, 10), Some(389));
        *ring.next() = 1000;
        assert_eq!((at(&mut ring, 0), at(&mut ring, 1)), (Some(1000), Some(389)));
        ring.clear();
        assert_eq!(at(&mut ring, 0), None);
        *ring.next() = 7;
        assert_eq!((at(&mut ring, 0), at(&mut ring, 1)), (Some(7), None));
    }
}
