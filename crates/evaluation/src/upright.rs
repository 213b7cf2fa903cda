//! How many characters are still up after ten seconds of random turns with one policy.

use std::sync::Arc;

use glam::Vec2;
use physics::Model;
use policy_core::training::TARGET_RANGE_METRES;
use policy_core::{CharacterPack, Command, Goal, NodeId};
use random::Rng;
use rayon::prelude::*;
use serde::Serialize;

use super::eval_character::{EvalCharacter, SETTLE_SECS};
use crate::trial::TICK_SECS;

/// Length of the test, seconds.
const TEST_SECS: f32 = 10.0;

/// What one policy does by itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct UprightReport {
    /// Share of characters that never fell.
    pub share: f32,
    /// Their mean speed towards the target after the first two seconds, metres per second.
    pub speed_mps: f32,
}

/// Share of characters that 10 s of turns of up to 90 degrees every 2 s leave on their feet, and their speed towards the
/// target. Started from walking, or from standing for a policy that stands.
#[must_use]
pub fn measure_upright(
    model: &Model,
    pack: &Arc<CharacterPack>,
    node: NodeId,
    characters: usize,
) -> UprightReport {
    let speeds: Vec<Option<f32>> =
        (0..characters).into_par_iter().map(|i| walk(model, pack, node, i as u64)).collect();
    let up: Vec<f32> = speeds.iter().flatten().copied().collect();
    UprightReport {
        share: up.len() as f32 / characters.max(1) as f32,
        speed_mps: up.iter().sum::<f32>() / up.len().max(1) as f32,
    }
}

fn walk(model: &Model, pack: &Arc<CharacterPack>, node: NodeId, seed: u64) -> Option<f32> {
    let graph = pack.graph();
    let mut eval = EvalCharacter::at(model, pack, node);
    let stands = graph.node(node).stands();
    let mut rng = Rng::new(seed, 17);
    let (mut angle, mut along) = (0.0, 0.0);
    let ticks = (TEST_SECS / TICK_SECS) as u32;
    let settled = (SETTLE_SECS / TICK_SECS) as u32;
    for tick in 0..ticks {
        if tick % settled == 0 && tick > 0 {
            angle += rng.range(-1.0, 1.0) * std::f32::consts::FRAC_PI_2;
        }
        let before = eval.position();
        let target = (!stands).then_some(before + TARGET_RANGE_METRES * Vec2::from_angle(angle));
        let command = Command { target, goal: Goal::Node(node), ..Command::default() };
        if !eval.tick(&command) || eval.controller.report().fallen {
            return None;
        }
        if tick >= settled {
            along += (eval.position() - before).dot(Vec2::from_angle(angle));
        }
    }
    Some(along / ((ticks - settled) as f32 * TICK_SECS))
}
