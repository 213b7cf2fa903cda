//! Small discriminators for packs. A discriminator that teaches a policy is large; one that ends a skill only has to agree with it
//! on the motions of a game. A small network learns its logits on rollouts of the pack's own skills.

use std::sync::Arc;

use physics_bridge::Model;
use policy_core::{CharacterPack, SkillId};
use random::Rng;
use rayon::prelude::*;

use super::TrainedSkill;
use super::rollouts::inputs;
use crate::nn::{Adam, Network, Pass, sigmoid};
use crate::ppo::BatchEvaluator;

/// Hidden sizes of a small discriminator.
pub const DISTILLED_HIDDEN: [usize; 2] = [96, 32];

/// Logits are learned up to this size: beyond it scores are 0.002 and 0.998, and no threshold lies there.
const LOGIT_LIMIT: f32 = 6.0;

/// Gradient steps, rows of each, and the first learning rate, which falls to nothing.
const STEPS: usize = 4000;
const BATCH: usize = 512;
const LEARNING_RATE: f32 = 1e-3;

/// One row of so many is kept to measure with.
const HELD_OUT: usize = 10;

/// How well a small discriminator agrees with the large one, on rows that it did not learn from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Agreement {
    /// Rows measured.
    pub rows: usize,
    /// Share of them on the same side of the skill's threshold.
    pub same_side: f32,
    /// Mean difference of the scores, which lie in [0, 1].
    pub score_error: f32,
}

/// Small discriminators in place of those that end the skills of a pack, by the name of their skill. `trained` holds the large
/// ones. `episodes` rollouts are made for each skill.
#[must_use]
pub fn distil(
    model: &Model,
    pack: &Arc<CharacterPack>,
    trained: &[TrainedSkill],
    episodes: usize,
) -> Vec<(String, Network, Agreement)> {
    let entries = &pack.manifest().discriminators;
    let small = entries.par_iter().enumerate().filter_map(|(stream, entry)| {
        let large = &trained.iter().find(|t| t.skill == entry.name)?.discriminator;
        let mut rows = Vec::new();
        let mut threshold = 0.5;
        for (index, skill) in pack.manifest().skills.iter().enumerate() {
            if skill.discriminator.as_ref() == Some(&entry.name) {
                rows.extend(inputs(model, pack, SkillId::new(index), episodes));
                threshold = skill.end.threshold;
            }
        }
        let (network, agreement) = regress(large, &rows, threshold, (STEPS, stream as u64))?;
        Some((entry.name.clone(), network, agreement))
    });
    small.collect()
}

/// A small network with the logits of a large one on these rows, after so many gradient steps; `None` when there are too few
/// rows.
fn regress(
    large: &Network,
    rows: &[f32],
    threshold: f32,
    (steps, stream): (usize, u64),
) -> Option<(Network, Agreement)> {
    let width = large.inputs();
    let count = rows.len() / width;
    if count < 2 * HELD_OUT {
        return None;
    }
    let logits = logits_of(large, rows);
    let row = |index: usize| &rows[index * width..(index + 1) * width];
    let (measured, learned): (Vec<usize>, Vec<usize>) = (0..count).partition(|i| i % HELD_OUT == 0);
    let mut rng = Rng::new(7, 50 + stream);
    let mut sizes = vec![width];
    sizes.extend(DISTILLED_HIDDEN);
    sizes.push(1);
    let mut small = Network::new(&sizes, 1.0, &mut rng);
    let mut adam = Adam::new(small.parameters.len());
    let mut pass = Pass::new(&sizes, BATCH);
    let (mut input, mut wanted) = (vec![0.0; BATCH * width], vec![0.0; BATCH]);
    let mut gradient = vec![0.0; small.parameters.len()];
    for step in 0..steps {
        for (input, wanted) in input.chunks_exact_mut(width).zip(&mut wanted) {
            let index = learned[rng.index(learned.len())];
            input.copy_from_slice(row(index));
            *wanted = logits[index].clamp(-LOGIT_LIMIT, LOGIT_LIMIT);
        }
        pass.forward(&small, None, &input);
        let (outputs, deltas) = pass.output_and_delta(BATCH);
        for ((output, delta), wanted) in outputs.iter().zip(deltas).zip(&wanted) {
            // Where both are beyond the limit, they agree.
            let beyond = output.abs() > LOGIT_LIMIT && output.signum() * wanted >= LOGIT_LIMIT;
            *delta = if beyond { 0.0 } else { (output - wanted) / BATCH as f32 };
        }
        gradient.fill(0.0);
        pass.backward(&small, None, &input, &mut gradient, None);
        let left = 1.0 - step as f32 / steps as f32;
        adam.step(&mut small.parameters, &gradient, LEARNING_RATE * left, 0.0);
    }
    let held: Vec<f32> = measured.iter().flat_map(|index| row(*index).iter().copied()).collect();
    let found = logits_of(&small, &held);
    let pairs =
        || measured.iter().map(|index| sigmoid(logits[*index])).zip(found.iter().map(|l| sigmoid(*l)));
    let same = pairs().filter(|(a, b)| (*a >= threshold) == (*b >= threshold)).count();
    let error: f32 = pairs().map(|(a, b)| (a - b).abs()).sum();
    let rows = measured.len();
    let agreement =
        Agreement { rows, same_side: same as f32 / rows as f32, score_error: error / rows as f32 };
    Some((small, agreement))
}

fn logits_of(network: &Network, rows: &[f32]) -> Vec<f32> {
    let mut logits = vec![0.0; rows.len() / network.inputs()];
    BatchEvaluator::new(network.sizes()).evaluate(network, None, rows, &mut logits);
    logits
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_network_learns_the_logits_of_a_large_one() {
        let mut rng = Rng::new(3, 1);
        let large = Network::new(&[6, 16, 1], 1.0, &mut rng);
        let rows: Vec<f32> = (0..4000 * 6).map(|_| rng.normal()).collect();
        let (small, agreement) = regress(&large, &rows, 0.5, (300, 0)).unwrap();
        assert_eq!(small.sizes(), [6, 96, 32, 1]);
        assert_eq!(agreement.rows, 400);
        assert!(agreement.same_side > 0.93 && agreement.score_error < 0.05, "{agreement:?}");
    }

    #[test]
    fn too_few_rows_teach_nothing() {
        let large = Network::new(&[6, 8, 1], 1.0, &mut Rng::new(3, 1));
        assert!(regress(&large, &[0.0; 60], 0.5, (300, 0)).is_none());
    }
}
