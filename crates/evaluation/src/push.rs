//! How hard a character may be pushed.

use std::sync::Arc;

use glam::{Quat, Vec3};
use physics::{Model, PhysicsCharacter};
use policy_core::{CharacterPack, NodeId};
use random::Rng;
use rayon::prelude::*;

use super::eval_character::{EvalCharacter, SETTLE_SECS};
use crate::trial::TICK_SECS;

/// Length of a push, seconds.
pub(crate) const PUSH_SECS: f32 = 0.2;

/// Largest push tried, newton.
const MOST_NEWTON: f32 = 2000.0;

/// The largest push of 0.2 s on the pelvis along `direction`, in newton, that 95 of 100 characters survive for 3 s; x is the
/// way that a character goes. Found by halving. Each character starts at another speed, goes another way and is pushed at
/// another moment of its gait.
#[must_use]
pub fn measure_push(
    model: &Model,
    pack: &Arc<CharacterPack>,
    node: NodeId,
    direction: Vec3,
    characters: usize,
) -> f32 {
    let survives = |newton: f32| {
        let survivors = (0..characters)
            .into_par_iter()
            .filter(|i| stays_up(model, pack, node, direction * newton, *i as u64))
            .count();
        survivors * 100 >= characters * 95
    };
    if !survives(0.0) {
        return 0.0;
    }
    let (mut low, mut high) = (0.0, MOST_NEWTON);
    while high - low > 15.0 {
        let middle = 0.5 * (low + high);
        if survives(middle) { low = middle } else { high = middle }
    }
    low
}

fn stays_up(model: &Model, pack: &Arc<CharacterPack>, node: NodeId, force: Vec3, seed: u64) -> bool {
    let mut rng = Rng::new(seed, 9);
    let before = ((SETTLE_SECS + rng.range(0.0, 1.0)) / TICK_SECS) as u32;
    let (mut eval, way) = EvalCharacter::at_by_chance(model, pack, node, &mut rng);
    let force = Quat::from_rotation_z(way) * force;
    for tick in 0..before + (3.0 / TICK_SECS) as u32 {
        if tick == before {
            eval.character
                .push(pack.skeleton().root(), force, PUSH_SECS)
                .expect("forces tried are within bounds");
        }
        let command = eval.along(node, way);
        if !eval.tick(&command) || eval.controller.report().fallen {
            return false;
        }
    }
    true
}
