//! Stops: how long and how far the character goes on after the stick is released.

use policy_core::Heading;
use serde::{Deserialize, Serialize};

use crate::Rig;
use crate::trial::{Settled, TICK_SECS, median, ticks};

/// A character that is slower has stopped, metres per second.
const STOPPED_MPS: f32 = 0.15;

/// Once it has been so for this long, seconds.
const HOLD_SECS: f32 = 0.3;

/// A stop that takes longer never comes, seconds.
const LIMIT_SECS: f32 = 12.0;

/// A character that has stopped is watched for this long, seconds.
const WATCHED_SECS: f32 = 3.0;

/// A stop by rule of thumb, seconds.
pub(in super::super) const NOMINAL_SECS: f32 = 1.5 + WATCHED_SECS;

/// Medians over stops; `None` when half of them never come.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct StopReport {
    /// Seconds until the pelvis is slower than 0.15 m/s for 0.3 s.
    pub s: Option<f32>,
    /// Metres gone until then.
    pub m: Option<f32>,
    /// Stops that do not come within 12 s.
    pub never: usize,
    /// Stops after which the pelvis is faster than 0.15 m/s again within 3 s: the character steps about.
    pub moved_again: usize,
    /// Median of the angle by which the character has turned 3 s after the stop, degrees.
    pub turned_degrees: Option<f32>,
    /// Median of the speed at the end of each stop, or 12 s after the stick was released, metres per second.
    pub last_mps: Option<f32>,
    /// Stops tried.
    pub trials: usize,
    /// Stops in which the character falls.
    pub falls: usize,
}

/// One stop.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Stop {
    secs: Option<f32>,
    metres: f32,
    last_mps: f32,
    moved_again: bool,
    turned: f32,
    fell: bool,
}

/// Stops of each of the settled characters of a gait. The stick is released; triggers and buttons stay held, so a crouch stops in a
/// crouch.
#[must_use]
pub fn measure_stops(rig: &Rig<'_>, settled: &[Settled]) -> StopReport {
    let stops = rig.each(settled, NOMINAL_SECS, |from| stop(rig, from));
    StopReport {
        s: median(stops.iter().map(|stop| stop.secs)),
        m: median(stops.iter().map(|stop| stop.secs.map(|_| stop.metres))),
        never: stops.iter().filter(|stop| stop.secs.is_none()).count(),
        moved_again: stops.iter().filter(|stop| stop.moved_again).count(),
        turned_degrees: median(stops.iter().map(|stop| stop.secs.map(|_| stop.turned.to_degrees()))),
        last_mps: median(stops.iter().map(|stop| Some(stop.last_mps))),
        trials: stops.len(),
        falls: stops.iter().filter(|stop| stop.fell).count(),
    }
}

fn stop(rig: &Rig<'_>, from: &Settled) -> Stop {
    let mut trial = from.resume(rig.model);
    trial.steer(0.0, 0.0);
    let (start, heading) = (trial.position(), trial.heading());
    let (mut stop, mut held) = (Stop::default(), 0);
    for tick in 1..=ticks(LIMIT_SECS + HOLD_SECS) {
        if !trial.tick() || trial.is_down() {
            stop.fell = true;
            break;
        }
        stop.last_mps = trial.velocity.value().length();
        held = if stop.last_mps < STOPPED_MPS { held + 1 } else { 0 };
        if held <= 1 {
            stop.metres = trial.position().distance(start);
        }
        if held > ticks(HOLD_SECS) {
            stop.secs = Some((tick + 1 - held) as f32 * TICK_SECS);
            break;
        }
    }
    if stop.secs.is_some() {
        for _ in 0..ticks(WATCHED_SECS) {
            if !trial.tick() || trial.is_down() {
                stop.fell = true;
                break;
            }
            stop.moved_again |= trial.velocity.value().length() > STOPPED_MPS;
        }
        let turned = Heading::from_angle(trial.heading() - heading).angle();
        stop.turned = turned.abs();
    }
    stop
}
