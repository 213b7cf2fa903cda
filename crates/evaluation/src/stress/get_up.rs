//! Getting up on uneven ground, and staying up.

use std::collections::BTreeMap;

use glam::Vec2;
use physics::{Model, ModelError, PhysicsCharacter};
use policy_core::SkillId;
use random::Rng;
use random::limp::drop_limp;
use serde::{Deserialize, Serialize};

use crate::Rig;
use crate::trial::{Gait, TICK_SECS, Trial, median, ticks};

/// Half the side of the square in which characters are dropped, metres.
const DROP_METRES: f32 = 15.0;

/// A character that takes longer does not get up, seconds.
const LIMIT_SECS: f32 = 5.0;

/// Once upright for this long it has got up, seconds.
const HOLD_SECS: f32 = 0.3;

/// A character that has got up is watched for this long, seconds.
const AFTER_SECS: f32 = 5.0;

/// A try by rule of thumb, seconds.
pub(crate) const NOMINAL_SECS: f32 = 10.0;

/// Drops on one ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct GetUpReport {
    /// Share that stands within 5 s, 0 to 1.
    pub success: f32,
    /// Share of those that falls again within 5 s of standing, 0 to 1.
    pub falls_again: f32,
    /// Median of the seconds until it stands; `None` when half do not.
    pub median_s: Option<f32>,
    /// Drops.
    pub trials: usize,
}

/// Seconds until a character stands, and whether it fell again.
type Try = (Option<f32>, bool);

/// Drops by ground; empty for a pack without a skill that gets up, or without a gait that stands.
///
/// # Errors
/// When the model can't be set on uneven ground.
pub fn measure_get_up_on_terrain(rig: &Rig<'_>) -> Result<BTreeMap<String, GetUpReport>, ModelError> {
    let mut grounds = BTreeMap::new();
    let Some((skill, idle)) = rig.pack.recovery().zip(Gait::named(rig.pack, "idle")) else {
        return Ok(grounds);
    };
    let seeds: Vec<u64> = (0..rig.effort.drops_uneven as u64).collect();
    for (name, terrain) in rig.effort.grounds.terrains() {
        let model = rig.model.with_terrain(terrain)?;
        let tries = rig.each(&seeds, NOMINAL_SECS, |seed| get_up(rig, &model, &idle, skill, *seed));
        grounds.insert(name.into(), GetUpReport::of(&tries));
    }
    Ok(grounds)
}

impl GetUpReport {
    fn of(tries: &[Try]) -> Self {
        let stood = tries.iter().filter(|(secs, _)| secs.is_some()).count();
        let again = tries.iter().filter(|(_, again)| *again).count();
        Self {
            success: stood as f32 / tries.len().max(1) as f32,
            falls_again: again as f32 / stood.max(1) as f32,
            median_s: median(tries.iter().map(|(secs, _)| *secs)),
            trials: tries.len(),
        }
    }
}

fn get_up(rig: &Rig<'_>, model: &Model, idle: &Gait, skill: SkillId, seed: u64) -> Try {
    let mut rng = Rng::new(seed, 43);
    let mut trial = Trial::new(model, rig.pack, rig.fragile_config(), idle);
    let place = Vec2::new(rng.range(-DROP_METRES, DROP_METRES), rng.range(-DROP_METRES, DROP_METRES));
    if !drop_limp(&mut trial.character, place, &mut rng) {
        return (None, false);
    }
    trial.character.sense_into(&mut trial.state);
    let mut held = 0;
    for tick in 1..=ticks(LIMIT_SECS + HOLD_SECS) {
        if !trial.tick_with(|command| command.skill = (tick == 1).then_some(skill)) {
            return (None, false);
        }
        held = if trial.is_upright() { held + 1 } else { 0 };
        if held > ticks(HOLD_SECS) {
            let secs = (tick + 1 - held) as f32 * TICK_SECS;
            let low = rig.pack.graph().node(idle.start).fall_height.unwrap_or(0.0);
            // The skill may raise it still, and tells no fall.
            let stays = (0..ticks(AFTER_SECS))
                .all(|_| trial.tick() && !trial.is_down() && trial.pelvis_height() >= low);
            return (Some(secs), !stays);
        }
    }
    (None, false)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn falls_again_are_a_share_of_those_that_stood() {
        let tries = [(Some(1.0), false), (Some(2.0), true), (None, false), (Some(4.0), false)];
        let report = GetUpReport::of(&tries);
        assert_eq!((report.success, report.median_s, report.trials), (0.75, Some(2.0), 4));
        assert!((report.falls_again - 1.0 / 3.0).abs() < 1e-6);
        assert_eq!(GetUpReport::of(&[]), GetUpReport::default());
    }
}
