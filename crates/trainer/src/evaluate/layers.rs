//! Interpolation of single layers (paper, section 4.3): does the motion change, and does the character stay up?

use std::sync::Arc;

use glam::Vec2;
use physics_bridge::Model;
use policy_core::{Blend, CharacterPack, CharacterState, Command, Goal, MAX_LAYERS, TARGET_RANGE_METRES};
use rayon::prelude::*;
use serde::Serialize;

use super::motion::pose_error;
use super::subject::{SETTLE_SECS, Subject};
use crate::Rng;
use crate::env::DT_SECS;

/// Seconds with the layers half-way.
const TEST_SECS: f32 = 8.0;

/// Layers of a policy: two hidden ones and the output.
const LAYERS: usize = 3;

/// Some layers half-way from one policy to another, the rest the first policy's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct LayerReport {
    /// Share of characters that did not fall in 8 s straight ahead.
    pub without_fall: f32,
    /// Mean distance of the bodies from the motion of the first policy alone, under dynamic time warping, metres.
    pub change_m: f32,
    /// The same between two characters that both act as the first policy: what is no change.
    pub noise_m: f32,
}

/// Every choice of layers but none and all, as a bit for each layer, with its name: `1`, `2`, `1+2`, ...
pub fn choices() -> impl Iterator<Item = (usize, String)> {
    (1..(1 << LAYERS) - 1).map(|bits| {
        let chosen: Vec<String> =
            (0..LAYERS).filter(|layer| bits >> layer & 1 == 1).map(|layer| (layer + 1).to_string()).collect();
        (bits, chosen.join("+"))
    })
}

/// Blends the layers in `bits` half-way from node `from` to node `to`, for `characters` that go straight ahead.
#[must_use]
pub fn measure_layers(
    model: &Model,
    pack: &Arc<CharacterPack>,
    (from, to): (usize, usize),
    bits: usize,
    characters: usize,
) -> LayerReport {
    let mut t = [0.0; MAX_LAYERS];
    (0..LAYERS).filter(|layer| bits >> layer & 1 == 1).for_each(|layer| t[layer] = 0.5);
    let blend = Blend::between_per_layer(from, to, t);
    let walked: Vec<_> = (0..characters)
        .into_par_iter()
        .map(|i| {
            let alone = walk(model, pack, from, None, i as u64);
            let other = walk(model, pack, from, None, (i + characters) as u64);
            (walk(model, pack, from, Some(blend), i as u64), alone, other)
        })
        .collect();
    let mean = |pairs: Vec<f32>| pairs.iter().sum::<f32>() / pairs.len().max(1) as f32;
    let both = |pick: &dyn Fn(usize) -> Option<f32>| mean((0..walked.len()).filter_map(pick).collect());
    LayerReport {
        without_fall: walked.iter().filter(|(w, ..)| w.is_some()).count() as f32 / characters.max(1) as f32,
        change_m: both(&|i| Some(pose_error(walked[i].0.as_deref()?, walked[i].1.as_deref()?))),
        noise_m: both(&|i| Some(pose_error(walked[i].2.as_deref()?, walked[i].1.as_deref()?))),
    }
}

/// States of a character that goes straight ahead; `None` when it falls after it has settled.
fn walk(
    model: &Model,
    pack: &Arc<CharacterPack>,
    node: usize,
    blend: Option<Blend>,
    seed: u64,
) -> Option<Vec<CharacterState>> {
    let graph = pack.graph();
    let mut subject = Subject::new(model, pack, &graph.nodes()[node].name);
    let stands = graph.nodes()[node].speed_mps == Some(0.0);
    let settle = ((SETTLE_SECS + Rng::new(seed, 19).range(0.0, 1.0)) / DT_SECS) as u32;
    let mut states = Vec::new();
    for tick in 0..settle + (TEST_SECS / DT_SECS) as u32 {
        let ahead = subject.position() + Vec2::new(TARGET_RANGE_METRES, 0.0);
        let command = Command {
            target: (!stands).then_some(ahead),
            goal: Goal::Node(node),
            blend: blend.filter(|_| tick >= settle),
            ..Command::default()
        };
        if !subject.tick(&command) || subject.controller.report().fallen {
            return None;
        }
        if tick >= settle {
            states.push(subject.state);
        }
    }
    Some(states)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn six_of_the_eight_choices_are_neither_policy() {
        let names: Vec<String> = choices().map(|(_, name)| name).collect();
        assert_eq!(names, ["1", "2", "1+2", "3", "1+3", "2+3"]);
    }
}
