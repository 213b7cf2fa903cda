//! Turns: how long until the character goes where the stick points, and how far it is carried on meanwhile.

use std::collections::BTreeMap;
use std::f32::consts::PI;

use glam::Vec2;
use serde::{Deserialize, Serialize};

use crate::Rig;
use crate::trial::{Settled, TICK_SECS, median, quantile, ticks};

/// Angles that are asked for, degrees, to the left and to the right.
pub const TURNS_DEGREES: [u32; 4] = [45, 90, 135, 180];

/// A turn that takes longer never ends, seconds.
const LIMIT_SECS: f32 = 12.0;

/// A turn by rule of thumb, seconds.
const NOMINAL_SECS: f32 = 4.0;

/// The direction of the velocity may be off by this much, radians.
const TOLERANCE: f32 = 20.0 * PI / 180.0;

/// And has to stay there for this long, seconds.
const HOLD_SECS: f32 = 0.3;

/// A velocity below this has no direction, metres per second.
const LEAST_MPS: f32 = 0.1;

/// Turns of one angle, to both sides.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct TurnReport {
    /// Median of the seconds, `None` when half of the turns never end.
    pub median_s: Option<f32>,
    /// Seconds that nine of ten turns stay below, `None` when more never end.
    pub p90_s: Option<f32>,
    /// Turns that do not end within 12 s.
    pub never: usize,
    /// Turns tried.
    pub trials: usize,
    /// Median of the turns to the left.
    pub left_median_s: Option<f32>,
    /// Median of the turns to the right.
    pub right_median_s: Option<f32>,
    /// Median of the metres that the character is carried on in the old direction.
    pub metres: Option<f32>,
    /// Median of the seconds until the pelvis faces the direction as closely as the velocity does; `None` when half never do. A
    /// character that creeps aside or backwards moves the right way and has not turned.
    pub facing_median_s: Option<f32>,
    /// Turns in which the character falls.
    pub falls: usize,
}

/// Tells when the velocity has turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TurnDetector {
    wanted: Vec2,
    ticks: u32,
    held: u32,
}

impl TurnDetector {
    /// A detector for a direction, radians from x.
    #[must_use]
    pub fn new(angle: f32) -> Self {
        Self { wanted: Vec2::from_angle(angle), ticks: 0, held: 0 }
    }

    /// Takes the low-passed velocity, metres per second, of the next tick. Once it has stayed within 20 degrees of the direction for
    /// 0.3 s, returns the seconds from the start until it came there.
    pub fn tick(&mut self, velocity: Vec2) -> Option<f32> {
        let speed = velocity.length();
        let turned = speed > LEAST_MPS && velocity.dot(self.wanted) >= speed * TOLERANCE.cos();
        self.ticks += 1;
        self.held = if turned { self.held + 1 } else { 0 };
        (self.held > ticks(HOLD_SECS)).then(|| (self.ticks - self.held + 1) as f32 * TICK_SECS)
    }
}

/// One turn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Turn {
    secs: Option<f32>,
    facing_secs: Option<f32>,
    metres: f32,
    fell: bool,
}

/// Degrees, side (1 for left, -1 for right), and from which of the settled characters.
type Try = (u32, f32, usize);

/// Turns of [`TURNS_DEGREES`] to both sides, from each of the settled characters of a gait; by `turn_<degrees>`.
#[must_use]
pub fn measure_turns(rig: &Rig<'_>, settled: &[Settled]) -> BTreeMap<String, TurnReport> {
    let sides = TURNS_DEGREES.iter().flat_map(|degrees| [(*degrees, 1.0), (*degrees, -1.0)]);
    let tries: Vec<Try> =
        sides.flat_map(|(degrees, side)| (0..settled.len()).map(move |from| (degrees, side, from))).collect();
    let turns = rig.each(&tries, NOMINAL_SECS, |&(degrees, side, from)| {
        turn(rig, &settled[from], side * (degrees as f32).to_radians())
    });
    let report = |degrees: u32| {
        let of = |side: Option<f32>| {
            let asked = move |try_: &Try| try_.0 == degrees && side.is_none_or(|s| s == try_.1);
            tries.iter().zip(&turns).filter(move |(try_, _)| asked(try_)).map(|(_, turn)| turn)
        };
        TurnReport {
            median_s: median(of(None).map(|t| t.secs)),
            p90_s: quantile(of(None).map(|t| t.secs), 0.9),
            never: of(None).filter(|t| t.secs.is_none()).count(),
            trials: of(None).count(),
            left_median_s: median(of(Some(1.0)).map(|t| t.secs)),
            right_median_s: median(of(Some(-1.0)).map(|t| t.secs)),
            metres: median(of(None).map(|t| Some(t.metres))),
            facing_median_s: median(of(None).map(|t| t.facing_secs)),
            falls: of(None).filter(|t| t.fell).count(),
        }
    };
    TURNS_DEGREES.iter().map(|degrees| (format!("turn_{degrees}"), report(*degrees))).collect()
}

/// A turn by an angle, radians, from where the character goes, or from where it faces if it stands.
fn turn(rig: &Rig<'_>, from: &Settled, angle: f32) -> Turn {
    let mut trial = from.resume(rig.model);
    let ahead = trial.ahead();
    let [mut velocity, mut heading] = [TurnDetector::new(ahead + angle); 2];
    let start = trial.position();
    trial.steer(ahead + angle, from.gait.push);
    let mut turn = Turn::default();
    for _ in 0..ticks(LIMIT_SECS + HOLD_SECS) {
        if !trial.tick() || trial.is_down() {
            turn.fell = true;
            break;
        }
        turn.facing_secs = turn.facing_secs.or_else(|| heading.tick(Vec2::from_angle(trial.heading())));
        if turn.secs.is_none() {
            turn.metres = turn.metres.max((trial.position() - start).dot(Vec2::from_angle(ahead)));
            turn.secs = velocity.tick(trial.velocity.value());
        }
        if turn.secs.is_some() && turn.facing_secs.is_some() {
            break;
        }
    }
    turn
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trial::LowPass;

    /// Seconds that the detector tells for a velocity that turns to the left at a rate, radians per second.
    fn detected(angle: f32, rate: f32, speed: f32) -> Option<f32> {
        let mut detector = TurnDetector::new(angle);
        (1..=400).find_map(|tick| {
            let now = (rate * tick as f32 * TICK_SECS).min(angle);
            detector.tick(speed * Vec2::from_angle(now))
        })
    }

    #[test]
    fn a_steady_turn_ends_20_degrees_before_its_angle() {
        let secs = detected(PI, PI / 3.0, 1.0).unwrap();
        assert!((secs - 3.0 * 160.0 / 180.0).abs() <= TICK_SECS, "{secs}");
        assert_eq!(detected(PI, 0.1, 1.0), None);
        assert_eq!(detected(PI, PI / 3.0, 0.05), None);
    }

    #[test]
    fn a_velocity_that_only_passes_by_has_not_turned() {
        let mut detector = TurnDetector::new(0.0);
        // Through the wanted direction within a quarter of a second, and back for good after two seconds.
        for tick in 1..=60 {
            let angle = -1.0 + tick as f32 * TICK_SECS * 3.0;
            assert_eq!(detector.tick(Vec2::from_angle(angle)), None, "{tick}");
        }
        let secs = (0..30).find_map(|_| detector.tick(Vec2::X)).unwrap();
        assert!((secs - 61.0 * TICK_SECS).abs() < 1e-4, "{secs}");
    }

    #[test]
    fn the_filter_delays_a_flip_by_less_than_its_window() {
        let (mut filter, mut detector) = (LowPass::at(Vec2::X), TurnDetector::new(PI / 2.0));
        let secs = (0..60).find_map(|_| {
            filter.tick(Vec2::Y);
            detector.tick(filter.value())
        });
        assert!((0.1..0.2).contains(&secs.unwrap()), "{secs:?}");
    }
}
