//! How much an evaluation measures, and about how long each of its sections takes.

use policy_core::CharacterPack;

use super::Section;
use super::encounters::{RACE_SECS, nominal_secs};
use super::player::STRAIGHT_COORDINATES;
use super::press::bound_buttons;
use super::response::{STOP_SECS, WAYS};
use super::stress::{Cases, GET_UP_SECS, Grounds, PadKind, nominal_trials};
use super::trial::Gaits;

/// How much is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Characters in a measure of survival.
    pub characters: usize,
    /// Seconds each of them walks.
    pub secs: f32,
    /// Characters in a measure of survival on uneven ground.
    pub characters_uneven: usize,
    /// Coordinates along a path.
    pub coordinates: usize,
    /// Characters at each coordinate.
    pub characters_each: usize,
    /// Ragdoll drops and rolls.
    pub drops: usize,
    /// Characters that are pushed at each force, policy by policy.
    pub pushed: usize,
    /// Characters for each choice of layers.
    pub layered: usize,
    /// Characters that settle in each gait, to turn both ways, start and stop.
    pub settled: usize,
    /// Characters at each coordinate straight ahead.
    pub straight: usize,
    /// Characters at which each button is pressed in each gait.
    pub pressed: usize,
    /// Characters with each kind of pad at random.
    pub pad_players: usize,
    /// Seconds each of them plays.
    pub pad_secs: f32,
    /// Characters that roam in each gait, on each ground and in each case of robustness.
    pub roamers: usize,
    /// Seconds each of them roams.
    pub roam_secs: f32,
    /// Ragdoll drops on each uneven ground.
    pub drops_uneven: usize,
    /// Settled characters that are pushed from each side in each gait.
    pub shoved: usize,
    /// How exactly the largest push is found in each gait, newton.
    pub push_step_newton: f32,
    /// Tries of each encounter with others, balls, crates, a door and stairs.
    pub encounters: usize,
    /// Runs over the playground's course.
    pub races: usize,
    /// The gaits in which a measure by gait is taken.
    pub gaits: Gaits,
    /// The uneven grounds on which characters roam and get up.
    pub grounds: Grounds,
    /// The bodies and worlds that differ from training.
    pub cases: Cases,
}

impl Effort {
    /// What figures are published from.
    pub const FULL: Effort = Effort {
        characters: 256,
        characters_uneven: 64,
        secs: 60.0,
        coordinates: 11,
        characters_each: 32,
        drops: 1000,
        pushed: 64,
        layered: 16,
        settled: 24,
        straight: 16,
        pressed: 24,
        pad_players: 64,
        pad_secs: 60.0,
        roamers: 16,
        roam_secs: 60.0,
        drops_uneven: 200,
        shoved: 16,
        push_step_newton: 10.0,
        encounters: 48,
        races: 10,
        gaits: Gaits::ALL,
        grounds: Grounds::ALL,
        cases: Cases::ALL,
    };

    /// Less than three minutes on two idle cores, for a first look.
    pub const QUICK: Effort = Effort {
        characters: 32,
        characters_uneven: 8,
        secs: 20.0,
        coordinates: 5,
        characters_each: 8,
        drops: 64,
        pushed: 5,
        layered: 1,
        settled: 8,
        straight: 3,
        pressed: 4,
        pad_players: 16,
        pad_secs: 30.0,
        roamers: 4,
        roam_secs: 20.0,
        drops_uneven: 12,
        shoved: 16,
        push_step_newton: 50.0,
        encounters: 4,
        races: 1,
        gaits: Gaits::ALL,
        grounds: Grounds::ALL,
        cases: Cases::ALL,
    };

    /// The same with so many characters in every measure, and as many tries of each encounter; drops, seconds and runs over the course
    /// stay.
    #[must_use]
    pub fn with_characters(self, count: usize) -> Self {
        Self {
            characters: count,
            characters_uneven: count,
            characters_each: count,
            pushed: count,
            layered: count,
            settled: count,
            shoved: count,
            straight: count,
            pressed: count,
            pad_players: count,
            roamers: count,
            encounters: count,
            ..self
        }
    }

    /// The same for these gaits, grounds and cases alone; where there are none of a kind, for all of that kind.
    #[must_use]
    pub fn only(self, gaits: &[Gaits], grounds: &[Grounds], cases: &[Cases]) -> Self {
        Self {
            gaits: gaits.iter().copied().reduce(Gaits::and).unwrap_or(self.gaits),
            grounds: grounds.iter().copied().reduce(Grounds::and).unwrap_or(self.grounds),
            cases: cases.iter().copied().reduce(Cases::and).unwrap_or(self.cases),
            ..self
        }
    }

    /// About how long a section takes, in seconds of one character's time.
    #[must_use]
    pub fn nominal_secs(&self, section: Section, pack: &CharacterPack) -> f32 {
        let graph = pack.graph();
        let (nodes, paths, edges) = (graph.nodes().len(), graph.paths().len(), graph.edges().len());
        let gaits = self.gaits.of(pack).len();
        let of = |trials: usize, secs: f32| trials as f32 * secs;
        let roamed = of(gaits * self.roamers, self.roam_secs);
        match section {
            Section::Paths => {
                let each = 3 * self.characters + 2 * self.characters_uneven;
                of(paths * (each + self.coordinates * self.characters_each), self.secs)
            }
            Section::Upright => of(nodes * self.characters, 15.0),
            Section::Push => of(nodes * 2 * 9 * self.pushed, 12.0),
            Section::Motion => of(nodes, 25.0),
            Section::Layers => of(edges * 2 * 8 * self.layered, 20.0),
            Section::Skills => of(self.drops, 8.0 + 6.0 * pack.skills().len().saturating_sub(1) as f32),
            Section::Turns => of(gaits * self.settled, 6.0 + 8.0 * 4.0),
            Section::Starts => of(self.settled, 7.5),
            Section::Stops => of(gaits * self.settled, STOP_SECS),
            Section::Straight => of(paths * STRAIGHT_COORDINATES * self.straight, 9.0),
            Section::Strafe if graph.path_named("strafe").is_none() => 0.0,
            Section::Strafe => of(WAYS * self.settled, 8.0),
            Section::Rise => of(self.settled, 5.0),
            Section::Buttons => of(gaits * self.pressed * bound_buttons(pack).len(), 6.0),
            Section::Jumps => of(self.settled * pack.skills().len(), 4.0),
            Section::Legs => of(gaits * self.settled, 8.0),
            Section::RandomPad => of(PadKind::ALL.len() * self.pad_players, self.pad_secs),
            Section::Terrain => roamed * self.grounds.count() as f32,
            Section::GetUp => of(self.grounds.count() * self.drops_uneven, GET_UP_SECS),
            Section::Robustness => roamed * self.cases.count() as f32,
            Section::Encounters => nominal_secs(self),
            Section::Race => of(self.races, RACE_SECS),
            Section::Pushes => {
                gaits as f32 * nominal_trials(self.push_step_newton, self.settled.min(self.shoved)) * 3.0
            }
        }
    }
}
