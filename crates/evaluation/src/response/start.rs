//! Starts: how long from standing until the character moves.

use serde::{Deserialize, Serialize};

use crate::Rig;
use crate::trial::{OFF_GROUND_METRES, Settled, TICK_SECS, median, ticks};

/// Speed of a walk that has started, metres per second.
const WALK_MPS: f32 = 0.9;

/// Speed of a run that has started, metres per second.
const RUN_MPS: f32 = 2.0;

/// A start that takes longer never comes, seconds.
const LIMIT_SECS: f32 = 12.0;

/// A start by rule of thumb, seconds.
const NOMINAL_SECS: f32 = 2.5;

/// Medians over starts straight ahead; `None` when half of them never come.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct StartReport {
    /// Seconds to 0.9 m/s with a full stick.
    pub walk_s: Option<f32>,
    /// Seconds to 2 m/s with a full stick and trigger.
    pub run_s: Option<f32>,
    /// Seconds until a foot is off the ground, with a full stick.
    pub first_step_s: Option<f32>,
    /// Seconds from a crouch to 2 m/s with a full stick and trigger.
    pub crouch_run_s: Option<f32>,
    /// Walks that never start.
    pub walk_never: usize,
    /// Runs that never start.
    pub run_never: usize,
    /// Starts of each kind.
    pub trials: usize,
}

/// One start: seconds to the speed, and to the first foot off the ground.
type Start = (Option<f32>, Option<f32>);

/// Starts from standing (`idle`) and out of a crouch.
#[must_use]
pub fn measure_starts(rig: &Rig<'_>) -> StartReport {
    let (idle, crouch) = (rig.settled_in("idle"), rig.settled_in("crouch"));
    let all = |settled: &[Settled], trigger: f32, speed: f32| {
        rig.each(settled, NOMINAL_SECS, |from| start(rig, from, trigger, speed))
    };
    let walks = all(&idle, 0.0, WALK_MPS);
    let runs = all(&idle, 1.0, RUN_MPS);
    let never = |starts: &[Start]| starts.iter().filter(|start| start.0.is_none()).count();
    StartReport {
        walk_s: median(walks.iter().map(|start| start.0)),
        run_s: median(runs.iter().map(|start| start.0)),
        first_step_s: median(walks.iter().map(|start| start.1)),
        crouch_run_s: median(all(&crouch, 1.0, RUN_MPS).into_iter().map(|start| start.0)),
        walk_never: never(&walks),
        run_never: never(&runs),
        trials: walks.len(),
    }
}

fn start(rig: &Rig<'_>, from: &Settled, trigger: f32, speed_mps: f32) -> Start {
    let mut trial = from.resume(rig.model);
    trial.steer(0.0, 1.0);
    (trial.pad.left_trigger, trial.pad.right_trigger) = (0.0, trigger);
    let mut step = None;
    for tick in 1..=ticks(LIMIT_SECS) {
        if !trial.tick() || trial.is_down() {
            break;
        }
        let secs = tick as f32 * TICK_SECS;
        let foot_up = rig
            .pack
            .skeleton()
            .feet()
            .iter()
            .any(|foot| trial.character.clearance_of(*foot) > OFF_GROUND_METRES);
        if foot_up {
            step = step.or(Some(secs));
        }
        if trial.velocity.value().x >= speed_mps {
            return (Some(secs), step);
        }
    }
    (None, step)
}
