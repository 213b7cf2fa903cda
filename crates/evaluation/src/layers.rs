//! Interpolation of single layers (paper, section 4.3): does the motion change, and does the character stay up?

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use physics::Model;
use policy_core::training::MAX_LAYERS;
use policy_core::{Blend, CharacterPack, CharacterState, Command, NodeId};
use random::Rng;
use rayon::prelude::*;
use serde::Serialize;

use super::eval_character::{EvalCharacter, SETTLE_SECS};
use super::motion::pose_error;
use crate::trial::TICK_SECS;

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
fn choices() -> impl Iterator<Item = (usize, String)> {
    (1..(1 << LAYERS) - 1).map(|bits| {
        let chosen: Vec<String> =
            (0..LAYERS).filter(|layer| bits >> layer & 1 == 1).map(|layer| (layer + 1).to_string()).collect();
        (bits, chosen.join("+"))
    })
}

/// Blends each choice of layers half-way from node `from` to node `to`, for `characters` that go straight ahead, each another way
/// and from another speed.
#[must_use]
pub fn measure_layers(
    model: &Model,
    pack: &Arc<CharacterPack>,
    (from, to): (NodeId, NodeId),
    characters: usize,
) -> BTreeMap<String, LayerReport> {
    // The first policy alone, twice: what the motion is compared to, and how much that differs by itself.
    let alone = walk_all(model, pack, from, None, 0..characters);
    let other = walk_all(model, pack, from, None, characters..2 * characters);
    let noise_m = difference(&other, &alone);
    let measured = choices().map(|(bits, name)| {
        let mut t = [0.0; MAX_LAYERS];
        (0..LAYERS).filter(|layer| bits >> layer & 1 == 1).for_each(|layer| t[layer] = 0.5);
        let blend = Blend::between_per_layer(from.into(), to.into(), t);
        let blended = walk_all(model, pack, from, Some(blend), 0..characters);
        let up = blended.iter().flatten().count();
        let without_fall = up as f32 / characters.max(1) as f32;
        (name, LayerReport { without_fall, change_m: difference(&blended, &alone), noise_m })
    });
    measured.collect()
}

/// States of a character that goes straight ahead for 8 s with each layer `t` of the way from the first node's to the
/// second's, after it has settled; `None` when it falls.
#[must_use]
pub fn watch_layers(
    model: &Model,
    pack: &Arc<CharacterPack>,
    (from, to): (NodeId, NodeId),
    t: [f32; 3],
) -> Option<Vec<CharacterState>> {
    let mut weights = [0.0; MAX_LAYERS];
    weights[..LAYERS].copy_from_slice(&t);
    let blend = Blend::between_per_layer(from.into(), to.into(), weights);
    walk(EvalCharacter::at(model, pack, from), 0.0, from, Some(blend), SETTLE_SECS)
}

/// States of a walk; `None` when it ended in a fall.
type Walk = Option<Vec<CharacterState>>;

fn walk_all(
    model: &Model,
    pack: &Arc<CharacterPack>,
    node: NodeId,
    blend: Option<Blend>,
    seeds: Range<usize>,
) -> Vec<Walk> {
    let walk_of = |seed: usize| {
        let mut rng = Rng::new(seed as u64, 19);
        let settle_secs = SETTLE_SECS + rng.range(0.0, 1.0);
        let (eval, way) = EvalCharacter::at_by_chance(model, pack, node, &mut rng);
        walk(eval, way, node, blend, settle_secs)
    };
    seeds.into_par_iter().map(walk_of).collect()
}

/// Mean pose error between the walks of two lists that both ended on their feet.
fn difference(walks: &[Walk], others: &[Walk]) -> f32 {
    let errors: Vec<f32> = walks
        .iter()
        .zip(others)
        .filter_map(|(a, b)| Some(pose_error(a.as_deref()?, b.as_deref()?)))
        .collect();
    errors.iter().sum::<f32>() / errors.len().max(1) as f32
}

/// States of a character that goes straight along `way`; `None` when it falls.
fn walk(mut eval: EvalCharacter, way: f32, node: NodeId, blend: Option<Blend>, settle_secs: f32) -> Walk {
    let settle = (settle_secs / TICK_SECS) as u32;
    let mut states = Vec::new();
    for tick in 0..settle + (TEST_SECS / TICK_SECS) as u32 {
        let command = Command { blend: blend.filter(|_| tick >= settle), ..eval.along(node, way) };
        if !eval.tick(&command) || eval.controller.report().fallen {
            return None;
        }
        if tick >= settle {
            states.push(eval.state.clone());
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
