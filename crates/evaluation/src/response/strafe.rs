//! Strafing: facing where the camera looks, and going any way.

use std::collections::BTreeMap;

use glam::Vec2;
use policy_core::{Button, Heading};
use random::Rng;
use serde::{Deserialize, Serialize};

use super::turn::TurnDetector;
use crate::Rig;
use crate::trial::{Gait, TICK_SECS, Trial, mean, median, ticks};

/// How many ways to go are measured.
pub(crate) const WAYS: usize = 8;

/// Ways to go, from the way to face, degrees to the left.
const DIRECTIONS: [(&str, f32); WAYS] = [
    ("ahead", 0.0),
    ("ahead_left", 45.0),
    ("left", 90.0),
    ("back_left", 135.0),
    ("back", 180.0),
    ("back_right", -135.0),
    ("right", -90.0),
    ("ahead_right", -45.0),
];

/// Seconds that the button is held before anything is measured.
const SETTLE_SECS: f32 = 2.0;

/// Seconds measured.
const MEASURED_SECS: f32 = 4.0;

/// How far the camera turns then, degrees.
const CAMERA_DEGREES: f32 = 90.0;

/// Facing takes no longer, seconds.
const LIMIT_SECS: f32 = 6.0;

/// Strafing one way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct StrafeReport {
    /// Along the way asked for, metres per second, mean over the characters that do not fall.
    pub reached_mps: Option<f32>,
    /// Angle between the way gone and the way asked for, of whatever sign, degrees, mean.
    pub drift_degrees: Option<f32>,
    /// Angle between the heading of the pelvis and the way to face, of whatever sign, degrees, mean.
    pub heading_degrees: Option<f32>,
    /// Seconds until it faces where the camera looks after that turned by 90 degrees at once, median; `None` when half never do.
    pub camera_turn_s: Option<f32>,
    /// Characters that fall.
    pub falls: usize,
    /// Characters.
    pub trials: usize,
}

/// What one character did: mean velocity from the way to face, mean angle off it, and seconds to face another way.
type Way = (Vec2, f32, Option<f32>);

/// Characters walk, then hold the button of the strafing path and go one way; at last the camera turns. Nothing for a pack
/// without a path called `strafe`.
#[must_use]
pub fn measure_strafe(rig: &Rig<'_>) -> BTreeMap<String, StrafeReport> {
    let walk = Gait::named(rig.pack, "walk").filter(|_| rig.pack.graph().path_named("strafe").is_some());
    let Some(walk) = walk else { return BTreeMap::new() };
    let seeds: Vec<u64> = (0..rig.effort.settled as u64).collect();
    let report = |(name, degrees): (&str, f32)| {
        let asked = degrees.to_radians();
        let ways = rig.each(&seeds, SETTLE_SECS + MEASURED_SECS + 2.0, |seed| go(rig, &walk, asked, *seed));
        let upright = || ways.iter().flatten();
        let off = |way: &Way| way.0.angle_to(Vec2::from_angle(asked)).abs().to_degrees();
        let report = StrafeReport {
            reached_mps: mean(upright().map(|way| way.0.dot(Vec2::from_angle(asked)))),
            drift_degrees: mean(upright().map(off)),
            heading_degrees: mean(upright().map(|way| way.1.to_degrees())),
            camera_turn_s: median(upright().map(|way| way.2)),
            falls: ways.iter().filter(|way| way.is_none()).count(),
            trials: ways.len(),
        };
        (name.to_owned(), report)
    };
    DIRECTIONS.into_iter().map(report).collect()
}

fn go(rig: &Rig<'_>, walk: &Gait, asked: f32, seed: u64) -> Option<Way> {
    let mut rng = Rng::new(seed, 43);
    let mut trial = Trial::new(rig.model, rig.pack, rig.fragile_config(), walk);
    trial.place(Vec2::ZERO, rng.range(-0.2, 0.2));
    trial.steer(0.0, 1.0);
    let step = |trial: &mut Trial| (trial.tick() && !trial.is_down()).then_some(());
    for _ in 0..ticks(1.0 + rng.range(0.0, 1.0)) {
        step(&mut trial)?;
    }
    trial.pad.buttons.set(Button::RightStick, true);
    trial.steer(asked, 1.0);
    for _ in 0..ticks(SETTLE_SECS) {
        step(&mut trial)?;
    }
    let (start, mut off) = (trial.position(), 0.0);
    for _ in 0..ticks(MEASURED_SECS) {
        step(&mut trial)?;
        off += trial.heading().abs();
    }
    let heading = off / ticks(MEASURED_SECS) as f32;
    let velocity = (trial.position() - start) / (ticks(MEASURED_SECS) as f32 * TICK_SECS);
    let side = if rng.chance(0.5) { 1.0 } else { -1.0 };
    let camera = side * CAMERA_DEGREES.to_radians();
    trial.camera = Heading::from_angle(camera);
    let mut turned = TurnDetector::new(camera);
    for _ in 0..ticks(LIMIT_SECS) {
        step(&mut trial)?;
        if let Some(secs) = turned.tick(Vec2::from_angle(trial.heading())) {
            return Some((velocity, heading, Some(secs)));
        }
    }
    Some((velocity, heading, None))
}
