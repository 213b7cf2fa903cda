//! From a crawl to its feet: the left trigger is released, the stick stays pushed.

use serde::{Deserialize, Serialize};

use crate::Rig;
use crate::trial::{Settled, TICK_SECS, median, ticks};

/// A rise that takes longer never comes, seconds.
const LIMIT_SECS: f32 = 12.0;

/// A character is up once it has been so for this long, seconds.
const HOLD_SECS: f32 = 0.3;

/// Rises out of a crawl.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct RiseReport {
    /// Rises without a skill.
    pub by_itself: usize,
    /// Rises in which a skill had to help.
    pub by_skill: usize,
    /// Rises tried.
    pub trials: usize,
    /// Median of the seconds until it is upright, by whatever means; `None` when half never are.
    pub median_s: Option<f32>,
    /// The same of the rises without a skill; `None` when there are none.
    pub by_itself_median_s: Option<f32>,
}

/// Rises of all settled characters in `crawl`.
#[must_use]
pub fn measure_rise(rig: &Rig<'_>) -> RiseReport {
    let rises = rig.each(&rig.settled_in("crawl"), 5.0, |from| rise(rig, from));
    let by_itself = || rises.iter().filter(|(secs, skill)| secs.is_some() && !skill);
    RiseReport {
        by_itself: by_itself().count(),
        by_skill: rises.iter().filter(|(_, skill)| *skill).count(),
        trials: rises.len(),
        median_s: median(rises.iter().map(|(secs, _)| *secs)),
        by_itself_median_s: median(by_itself().map(|(secs, _)| *secs)),
    }
}

/// Seconds until the character is upright, and whether a skill started.
fn rise(rig: &Rig<'_>, from: &Settled) -> (Option<f32>, bool) {
    let mut trial = from.resume(rig.model);
    trial.pad.left_trigger = 0.0;
    trial.steer(0.0, 1.0);
    let (mut held, mut skill) = (0, false);
    for tick in 1..=ticks(LIMIT_SECS) {
        if !trial.tick() {
            break;
        }
        let report = trial.controller.report();
        skill |= report.skill_started.is_some();
        held = if trial.is_upright() && report.skill.is_none() { held + 1 } else { 0 };
        if held > ticks(HOLD_SECS) {
            return (Some((tick + 1 - held) as f32 * TICK_SECS), skill);
        }
    }
    (None, skill)
}
