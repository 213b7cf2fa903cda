//! What a character meets in a shared world: others, balls, crates, a door, stairs, and the playground's course.
//!
//! The world is MuJoCo's; every character is steered through a pad and gets up by itself.

mod cases;
mod cast;
mod race;

use serde::{Deserialize, Serialize};

pub use cases::measure_encounters;
pub use race::{RaceReport, measure_race};

pub(super) use cases::nominal_secs;
pub(super) use race::NOMINAL_SECS as RACE_SECS;

/// Seconds within which one that fell is to be up again.
const RISE_SECS: f32 = 6.0;

/// What came of an encounter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct EncounterReport {
    /// Characters that were in it.
    pub characters: usize,
    /// Share of them that did not fall, 0 to 1.
    pub stays_up: f32,
    /// Share of those that fell and were up again within six seconds; `None` when none fell.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gets_up: Option<f32>,
    /// Share of them that came to where they were going; `None` where there is no such place.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub arrives: Option<f32>,
}

/// How one character fared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Fate {
    fell: bool,
    /// It fell and was up again in time.
    rose: bool,
    /// Where there is a place to go to.
    arrived: Option<bool>,
}

impl EncounterReport {
    fn of(fates: &[Fate]) -> Self {
        let share = |some: usize, all: usize| (all > 0).then(|| some as f32 / all as f32);
        let count = |what: fn(&Fate) -> bool| fates.iter().filter(|fate| what(fate)).count();
        let fallen = count(|fate| fate.fell);
        let going = count(|fate| fate.arrived.is_some());
        Self {
            characters: fates.len(),
            stays_up: share(fates.len() - fallen, fates.len()).unwrap_or_default(),
            gets_up: share(count(|fate| fate.rose), fallen),
            arrives: share(count(|fate| fate.arrived == Some(true)), going),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_of_those_that_they_are_about() {
        let up = Fate { arrived: Some(true), ..Fate::default() };
        let lies = Fate { fell: true, arrived: Some(false), ..Fate::default() };
        let rose = Fate { fell: true, rose: true, arrived: None };
        let report = EncounterReport::of(&[up, up, lies, rose]);
        let expected =
            EncounterReport { characters: 4, stays_up: 0.5, gets_up: Some(0.5), arrives: Some(2.0 / 3.0) };
        assert_eq!(report, expected);
        assert_eq!(EncounterReport::of(&[up]).gets_up, None);
    }
}
