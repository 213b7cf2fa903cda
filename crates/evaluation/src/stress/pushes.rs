//! Pushes from four sides, on torso and pelvis, in every gait: the largest that 15 of 16 characters survive.

use std::collections::BTreeMap;

use glam::{Quat, Vec3};
use physics::PhysicsCharacter;
use policy_core::BodyId;
use serde::{Deserialize, Serialize};

use super::bisect::largest;
use crate::Rig;
use crate::push::PUSH_SECS;
use crate::trial::{Settled, ticks};

/// A push is survived when the character stays up for this long, seconds.
const SURVIVED_SECS: f32 = 3.0;

/// Largest push tried, newton.
const MOST_NEWTON: f32 = 1000.0;

/// Of so many characters all but one have to survive.
const OF_WHICH_ONE_MAY_FALL: usize = 16;

/// Largest pushes, newton, by the side that they push to. Forward is where the character goes, or where it faces if it stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct SidesReport {
    /// From behind.
    pub forward_newton: f32,
    /// From the front.
    pub backward_newton: f32,
    /// From its right.
    pub left_newton: f32,
    /// From its left.
    pub right_newton: f32,
}

/// Largest pushes of 0.2 s that 15 of 16 characters survive for 3 s, by gait. A character stays in its gait.
#[must_use]
pub fn measure_pushes(rig: &Rig<'_>, body: BodyId) -> BTreeMap<String, SidesReport> {
    let measure = |gait: &_| {
        let settled = rig.settled(gait);
        let settled = &settled[..settled.len().min(rig.effort.shoved)];
        let side = |direction: Vec3| {
            largest(MOST_NEWTON, rig.effort.push_step_newton, |newton| {
                let up =
                    rig.each(settled, SURVIVED_SECS, |from| survives(rig, from, body, newton * direction));
                is_enough(up.into_iter().filter(|up| *up).count(), settled.len())
            })
        };
        SidesReport {
            forward_newton: side(Vec3::X),
            backward_newton: side(Vec3::NEG_X),
            left_newton: side(Vec3::Y),
            right_newton: side(Vec3::NEG_Y),
        }
    };
    rig.gaits().iter().map(|gait| (gait.name.into(), measure(gait))).collect()
}

/// True when no more than one of sixteen characters fell.
fn is_enough(up: usize, characters: usize) -> bool {
    characters > 0 && up * OF_WHICH_ONE_MAY_FALL >= characters * (OF_WHICH_ONE_MAY_FALL - 1)
}

/// Trials for one gait, by rule of thumb.
pub(crate) fn nominal_trials(step_newton: f32, shoved: usize) -> f32 {
    let tries = 2.0 + (MOST_NEWTON / step_newton).log2().ceil();
    2.0 * 4.0 * tries * shoved as f32
}

/// Whether it survives a push; x of the force is ahead.
fn survives(rig: &Rig<'_>, from: &Settled, body: BodyId, force: Vec3) -> bool {
    let mut trial = from.resume(rig.model);
    let force = Quat::from_rotation_z(trial.ahead()) * force;
    trial.character.push(body, force, PUSH_SECS).expect("forces tried are within bounds");
    (0..ticks(SURVIVED_SECS)).all(|_| trial.tick() && !trial.is_down())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_of_sixteen_may_fall_and_none_of_a_few() {
        assert!(is_enough(15, 16) && is_enough(16, 16) && is_enough(5, 5));
        assert!(!is_enough(14, 16) && !is_enough(4, 5) && !is_enough(0, 0));
    }
}
