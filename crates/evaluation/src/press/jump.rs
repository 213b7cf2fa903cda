//! How far the joint targets jump when a skill starts and when it ends.

use policy_core::Buttons;
use serde::{Deserialize, Serialize};

use super::bound_buttons;
use crate::Rig;
use crate::trial::{Settled, median, ticks};

/// Seconds that a character is watched after the press.
const WATCHED_SECS: f32 = 4.0;

/// Medians of the largest change of a joint target from one tick to the next, radians. `None` where no skill started or ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct JumpReport {
    /// In the tick in which a skill starts.
    pub skill_start_rad: Option<f32>,
    /// In the tick in which it ends.
    pub skill_end_rad: Option<f32>,
    /// In all other ticks of the walk and the skill.
    pub otherwise_rad: Option<f32>,
}

/// What one character did.
#[derive(Clone, Debug, Default)]
struct Jumps {
    start: Vec<f32>,
    end: Vec<f32>,
    otherwise: Vec<f32>,
}

/// Presses every button of a skill while it walks.
#[must_use]
pub fn measure_jumps(rig: &Rig<'_>) -> JumpReport {
    let settled = rig.settled_in("walk");
    let mut all = Jumps::default();
    for (button, _) in bound_buttons(rig.pack).into_iter().filter(|(_, skill)| skill.is_some()) {
        let pressed = Buttons::NONE.with(button);
        for jumps in rig.each(&settled, WATCHED_SECS, |from| watch(rig, from, pressed)) {
            all.start.extend(jumps.start);
            all.end.extend(jumps.end);
            all.otherwise.extend(jumps.otherwise);
        }
    }
    let of = |jumps: Vec<f32>| median(jumps.into_iter().map(Some));
    JumpReport {
        skill_start_rad: of(all.start),
        skill_end_rad: of(all.end),
        otherwise_rad: of(all.otherwise),
    }
}

fn watch(rig: &Rig<'_>, from: &Settled, pressed: Buttons) -> Jumps {
    let mut trial = from.resume(rig.model);
    let mut jumps = Jumps::default();
    trial.pad.buttons = pressed;
    let mut before = trial.controller.joint_targets().to_vec();
    for _ in 0..ticks(WATCHED_SECS) {
        if !trial.tick() {
            break;
        }
        trial.pad.buttons = Buttons::NONE;
        let now = trial.controller.joint_targets();
        let jump = largest_change(&before, now);
        before.copy_from_slice(now);
        let report = trial.controller.report();
        match (report.skill_started, report.skill_ended) {
            (Some(_), _) => jumps.start.push(jump),
            (None, Some(_)) => jumps.end.push(jump),
            (None, None) => jumps.otherwise.push(jump),
        }
    }
    jumps
}

/// Largest change of a number.
fn largest_change(before: &[f32], now: &[f32]) -> f32 {
    before.iter().zip(now).map(|(a, b)| (b - a).abs()).fold(0.0, f32::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_joint_that_moves_most_counts() {
        assert_eq!(largest_change(&[0.0, 1.0, -1.0], &[0.25, 0.5, -1.75]), 0.75);
    }
}
