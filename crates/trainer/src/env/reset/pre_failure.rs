//! Pre-failure resets: states shortly before failures, to start episodes from. A failure of once a minute is met often.

use physics_bridge::{Character, Snapshot};
use policy_core::training::FrameHistory;
use random::Rng;

use super::super::command::Command;
use super::keep_one;

/// Ticks between the states that a character keeps of an episode.
const EVERY_TICKS: u32 = 15;

/// A start lies at least so many ticks before its failure: later, no action helps.
const LEAST_TICKS: u32 = 30;

/// States kept of an episode: the last two and a half seconds.
const TRAIL: usize = 6;

/// Starts that a character keeps.
const STARTS: usize = 4;

/// A state to return to.
#[derive(Clone, Debug)]
pub(in super::super) struct SavedState {
    pub(super) snapshot: Snapshot,
    pub(super) history: FrameHistory,
    pub(super) command: Command,
}

/// The last states of the present episode, and starts from earlier ones.
#[derive(Debug, Default)]
pub(in super::super) struct PreFailureStates {
    /// States with their ticks of the episode, oldest overwritten.
    trail: Vec<(u32, SavedState)>,
    next: usize,
    ticks: u32,
    starts: Vec<SavedState>,
}

impl PreFailureStates {
    /// Begins a new episode.
    pub(in super::super) fn begin(&mut self) {
        (self.ticks, self.next) = (0, 0);
        self.trail.clear();
    }

    /// Counts a tick; true when the state should be kept.
    pub(in super::super) fn tick(&mut self) -> bool {
        self.ticks += 1;
        self.ticks.is_multiple_of(EVERY_TICKS)
    }

    /// Keeps this state, in place of the oldest one where there are enough.
    pub(in super::super) fn keep(&mut self, character: &Character, history: &FrameHistory, command: Command) {
        if self.trail.len() < TRAIL {
            let saved = SavedState { snapshot: character.save(), history: history.clone(), command };
            self.trail.push((self.ticks, saved));
            return;
        }
        let (ticks, saved) = &mut self.trail[self.next];
        *ticks = self.ticks;
        character.save_into(&mut saved.snapshot);
        saved.history.clone_from(history);
        saved.command = command;
        self.next = (self.next + 1) % TRAIL;
    }

    /// The episode has failed: keeps one of its last states as a start, if there is one early enough.
    pub(in super::super) fn failed(&mut self, rng: &mut Rng) {
        let early = self.trail.iter().filter(|(ticks, _)| ticks + LEAST_TICKS <= self.ticks);
        let count = early.clone().count();
        if count == 0 {
            return;
        }
        let (_, saved) = early.clone().nth(rng.index(count)).expect("an index below the count");
        keep_one(&mut self.starts, STARTS, saved.clone(), rng);
    }

    /// Takes a start out.
    pub(in super::super) fn take(&mut self, rng: &mut Rng) -> Option<SavedState> {
        (!self.starts.is_empty()).then(|| self.starts.swap_remove(rng.index(self.starts.len())))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use physics_bridge::Model;
    use policy_core::Heading;

    fn character() -> Character {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/humanoid.xml");
        let mut character = Character::new(&Model::load(path).unwrap());
        character.stand_at(0.0, 0.0, Heading::FORWARD, 0.0).unwrap();
        character
    }

    /// An episode of so many ticks that fails; the tick at which it began.
    fn fail_after(
        ticks: u32,
        character: &mut Character,
        states: &mut PreFailureStates,
        rng: &mut Rng,
    ) -> u64 {
        let began = character.tick();
        states.begin();
        for _ in 0..ticks {
            character.step().unwrap();
            if states.tick() {
                states.keep(character, &FrameHistory::new(125), Command::default());
            }
        }
        states.failed(rng);
        began
    }

    #[test]
    fn a_start_lies_one_to_two_and_a_half_seconds_before_its_failure() {
        let (mut character, mut states, mut rng) = (character(), PreFailureStates::default(), Rng::new(1, 0));
        let mut seen = std::collections::BTreeSet::new();
        for _ in 0..20 {
            let began = fail_after(140, &mut character, &mut states, &mut rng);
            let saved = states.take(&mut rng).unwrap();
            seen.insert(140 - (saved.snapshot.tick() - began));
            assert!(states.take(&mut rng).is_none(), "a start is used once");
        }
        // States are 15 ticks apart, the last one 5 ticks before the failure.
        assert!(seen.iter().all(|before| [35, 50, 65, 80].contains(before)) && seen.len() > 1, "{seen:?}");
    }

    #[test]
    fn a_failure_soon_after_the_start_leaves_nothing_and_many_leave_four() {
        let (mut character, mut states, mut rng) = (character(), PreFailureStates::default(), Rng::new(2, 0));
        fail_after(40, &mut character, &mut states, &mut rng);
        assert!(states.take(&mut rng).is_none());
        for _ in 0..6 {
            fail_after(60, &mut character, &mut states, &mut rng);
        }
        assert_eq!((0..9).filter(|_| states.take(&mut rng).is_some()).count(), STARTS);
    }
}
