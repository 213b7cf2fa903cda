//! Buttons that went down since the last tick: a tap between two ticks counts, also in slow motion.

use policy_core::{Button, Buttons};

/// What went down, until a tick has seen it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Latch {
    /// Held when it was looked at last.
    before: Buttons,
    /// Went down since the last tick.
    pressed: Buttons,
}

impl Latch {
    /// Takes the buttons that are held now.
    pub(super) fn see(&mut self, held: Buttons) {
        self.pressed = both(self.pressed, held.pressed_since(self.before));
        self.before = held;
    }

    /// Takes one that went down, and may be up again.
    pub(super) fn press(&mut self, button: Button) {
        self.pressed.set(button, true);
    }

    /// What is held and what went down, for the next tick.
    pub(super) fn state(&self, held: Buttons) -> Buttons {
        both(self.pressed, held)
    }

    /// A tick has seen it.
    pub(super) fn clear(&mut self) {
        self.pressed = Buttons::NONE;
    }
}

fn both(some: Buttons, others: Buttons) -> Buttons {
    let pressed = Button::ALL.into_iter().filter(|button| some.contains(*button) || others.contains(*button));
    pressed.fold(Buttons::NONE, Buttons::with)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tap_is_kept_until_a_tick_has_seen_it_and_counts_once() {
        let (a, none) = (Buttons::NONE.with(Button::South), Buttons::NONE);
        let mut latch = Latch::default();
        for held in [none, a, none, none] {
            latch.see(held);
        }
        assert_eq!(latch.state(none), a);
        assert!(latch.state(none.with(Button::East)).contains(Button::East));
        latch.clear();
        assert_eq!(latch.state(none), none);
        // One that is held does not go down again.
        latch.see(a);
        latch.clear();
        latch.see(a);
        assert_eq!((latch.state(none), latch.state(a)), (none, a));
    }
}
