//! A character that roams in one gait: straight ahead, a turn of up to 90 degrees every 2 to 5 s, back home from afar. One whose
//! gait stands is put elsewhere, walking, every 10 s, and stops there.

use std::f32::consts::FRAC_PI_2;

use glam::Vec2;
use physics::Model;
use random::Rng;
use serde::{Deserialize, Serialize};

use crate::Rig;
use crate::trial::{Disturbance, Gait, TICK_SECS, Trial, ticks};

/// Half the side of the square in which characters are put down, metres.
const START_METRES: f32 = 15.0;

/// From further away it turns towards the middle, metres.
const FAR_METRES: f32 = 28.0;

/// A character whose gait stands is put elsewhere after this time, seconds.
const STANDING_SECS: f32 = 10.0;

/// Falls of characters that roam.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct FallReport {
    /// Falls per minute of one character.
    pub falls_per_minute: f32,
    /// Falls.
    pub falls: u32,
    /// Minutes of all characters together.
    pub minutes: f32,
}

impl FallReport {
    /// Of the falls of each character in `secs`.
    pub(super) fn of(falls: &[u32], secs: f32) -> Self {
        let (minutes, falls) = (falls.len() as f32 * secs / 60.0, falls.iter().sum());
        Self { falls_per_minute: falls as f32 / minutes.max(1e-6), falls, minutes }
    }
}

/// Falls of a character of `model` that roams for `secs`.
pub(super) fn roam(
    rig: &Rig<'_>,
    model: &Model,
    gait: &Gait,
    disturb: impl FnOnce(Disturbance, &Trial, Rng) -> Disturbance,
    (secs, seed): (f32, u64),
) -> u32 {
    let mut rng = Rng::new(seed, 31);
    let mut trial = Trial::new(model, rig.pack, rig.fragile_config(), gait);
    trial.disturbance = disturb(Disturbance::default(), &trial, Rng::new(seed, 37));
    let (mut falls, mut angle, mut turn_in, mut stood) = (0, 0.0, 0.0, f32::INFINITY);
    for _ in 0..ticks(secs) {
        if stood > STANDING_SECS {
            angle = rng.angle();
            put_down(&mut trial, &mut rng, angle);
            (stood, turn_in) = (0.0, rng.range(2.0, 5.0));
        }
        turn_in -= TICK_SECS;
        if turn_in <= 0.0 {
            turn_in = rng.range(2.0, 5.0);
            angle += rng.range(-FRAC_PI_2, FRAC_PI_2);
        }
        if trial.position().length() > FAR_METRES {
            angle = (-trial.position()).to_angle();
        }
        trial.steer(angle, gait.settled_push());
        let down = !trial.tick() || trial.is_down();
        falls += u32::from(down);
        stood = match (down, gait.moves()) {
            (true, _) => f32::INFINITY,
            (false, true) => 0.0,
            (false, false) => stood + TICK_SECS,
        };
    }
    falls
}

fn put_down(trial: &mut Trial, rng: &mut Rng, angle: f32) {
    let place = Vec2::new(rng.range(-START_METRES, START_METRES), rng.range(-START_METRES, START_METRES));
    trial.place(place, angle);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn falls_are_per_minute_of_one_character() {
        let report = FallReport::of(&[0, 3, 1, 0], 30.0);
        assert_eq!(report, FallReport { falls_per_minute: 2.0, falls: 4, minutes: 2.0 });
        assert_eq!(FallReport::of(&[], 30.0).falls_per_minute, 0.0);
    }
}
