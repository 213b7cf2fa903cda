//! Straight ahead at the coordinates of a path: how fast, and how far off the asked direction.

use glam::Vec2;
use policy_core::{CharacterPack, Goal, NodeId, PathId};
use random::Rng;
use serde::{Deserialize, Serialize};

use crate::Rig;
use crate::trial::{Gait, TICK_SECS, Trial, mean, ticks};

/// Seconds at the coordinate before anything is measured.
const SETTLE_SECS: f32 = 3.0;

/// Seconds measured.
const MEASURED_SECS: f32 = 4.0;

/// Longest way through the graph, seconds.
const REACH_SECS: f32 = 10.0;

/// A way by rule of thumb, seconds.
const NOMINAL_SECS: f32 = SETTLE_SECS + MEASURED_SECS + 2.0;

/// A character that is slower goes nowhere, metres per second.
const LEAST_MPS: f32 = 0.1;

/// Straight ahead at one coordinate; means over the characters that do not fall.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct StraightPoint {
    /// Place on the path.
    pub coordinate: f32,
    /// Interpolated from the speeds of the nodes, metres per second.
    pub commanded_mps: f32,
    /// Along the asked direction, metres per second; `None` when all fall.
    pub reached_mps: Option<f32>,
    /// Angle between the way gone and the way asked for, of whatever sign, degrees; `None` when no character gets anywhere.
    pub drift_degrees: Option<f32>,
    /// The same with its sign, left positive.
    pub drift_left_degrees: Option<f32>,
    /// Angle between the heading of the pelvis and the way asked for, of whatever sign, degrees.
    pub heading_degrees: Option<f32>,
    /// Characters that fall.
    pub falls: usize,
    /// Characters.
    pub trials: usize,
}

/// What one character did: its mean velocity, and the mean angle of its heading.
type Way = (Vec2, f32);

/// Characters go straight ahead at a coordinate of a path. Below the path's second node the stick is pushed as far as the
/// coordinate says.
#[must_use]
pub fn measure_straight(rig: &Rig<'_>, path: PathId, coordinate: f32) -> StraightPoint {
    let Some(walk) = Gait::named(rig.pack, "walk") else { return StraightPoint::default() };
    let seeds: Vec<u64> = (0..rig.effort.straight as u64).collect();
    let ways = rig.each(&seeds, NOMINAL_SECS, |seed| go(rig, &walk, (path, coordinate), *seed));
    let upright = || ways.iter().flatten();
    let drifts = || upright().filter(|way| way.0.length() >= LEAST_MPS).map(|way| way.0.to_angle());
    StraightPoint {
        coordinate,
        commanded_mps: commanded_mps(rig.pack, path, coordinate),
        reached_mps: mean(upright().map(|way| way.0.x)),
        drift_degrees: mean(drifts().map(|angle| angle.abs().to_degrees())),
        drift_left_degrees: mean(drifts().map(f32::to_degrees)),
        heading_degrees: mean(upright().map(|way| way.1.abs().to_degrees())),
        falls: ways.iter().filter(|way| way.is_none()).count(),
        trials: ways.len(),
    }
}

fn go(rig: &Rig<'_>, walk: &Gait, (path, coordinate): (PathId, f32), seed: u64) -> Option<Way> {
    let mut rng = Rng::new(seed, 29);
    let mut trial = Trial::new(rig.model, rig.pack, rig.fragile_config(), walk);
    trial.place(Vec2::ZERO, rng.range(-0.2, 0.2));
    trial.steer(0.0, coordinate.min(1.0));
    let step = |trial: &mut Trial| {
        let sound = trial.tick_with(|command| command.goal = Goal::Path { path, coordinate });
        (sound && !trial.is_down()).then_some(())
    };
    for _ in 0..ticks(REACH_SECS) {
        step(&mut trial)?;
        if trial.has_arrived() {
            break;
        }
    }
    for _ in 0..ticks(SETTLE_SECS + rng.range(0.0, 1.0)) {
        step(&mut trial)?;
    }
    let start = trial.position();
    let mut heading = Vec2::ZERO;
    for _ in 0..ticks(MEASURED_SECS) {
        step(&mut trial)?;
        heading += Vec2::from_angle(trial.heading());
    }
    let secs = ticks(MEASURED_SECS) as f32 * TICK_SECS;
    Some(((trial.position() - start) / secs, heading.to_angle()))
}

/// Speed commanded at a coordinate: that of the nodes, interpolated, metres per second.
#[must_use]
pub fn commanded_mps(pack: &CharacterPack, path: PathId, coordinate: f32) -> f32 {
    let graph = pack.graph();
    let position = graph.path(path).position(coordinate);
    let speed = |node: NodeId| graph.node(node).speed_mps.unwrap_or(0.0);
    speed(position.from) + position.t * (speed(position.to) - speed(position.from))
}
