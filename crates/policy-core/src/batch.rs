//! Evaluation of a crowd: many characters, each with its own blend, in one call.
//!
//! Characters are ordered by the policies they use and taken in blocks, so that a policy's parameters are
//! read from the cache once for a group of blocks instead of once for each character.

use alloc::vec::Vec;

use crate::blend::Blend;
use crate::kernel::{Arithmetic, BLOCK, TILE};
use crate::mlp::Mlp;

/// Blocks that share one pass over the parameters.
const GROUP: usize = 8;

type Sums = [[f32; TILE]; BLOCK];

/// Room for one batch; owned by the caller and used again.
#[derive(Clone, Debug)]
pub struct BatchScratch {
    order: Vec<(u64, u32)>,
    /// Activations of a group: `[block][input][character]`.
    x: Vec<[f32; BLOCK]>,
    /// Sums of a group: `[block][panel]`.
    y: Vec<Sums>,
    width: usize,
    panels: usize,
}

impl BatchScratch {
    /// Room for `characters` characters and networks no wider than `mlp`.
    #[must_use]
    pub fn for_mlp(mlp: &Mlp, characters: usize) -> Self {
        let panels = mlp.layers().iter().map(|l| l.bias.len()).max().unwrap_or(0);
        let width = (panels * TILE).max(mlp.inputs());
        Self {
            order: Vec::with_capacity(characters),
            x: alloc::vec![[0.0; BLOCK]; GROUP * width],
            y: alloc::vec![[[0.0; TILE]; BLOCK]; GROUP * panels],
            width,
            panels,
        }
    }
}

/// Writes the outputs of many interpolated networks: `inputs` holds one row for each of `blends`, `out`
/// likewise. Agrees with [`Blend::evaluate_into`] of each character to rounding, and does not allocate
/// while there are no more characters than `scratch` was made for.
///
/// # Panics
/// When `inputs` or `out` has the wrong length, a blend is empty or names a policy that is not there, the
/// policies differ in shape, or `scratch` was made for narrower networks.
pub fn evaluate_batch_into(
    policies: &[Mlp],
    arithmetic: Arithmetic,
    blends: &[Blend],
    inputs: &[f32],
    scratch: &mut BatchScratch,
    out: &mut [f32],
) {
    let Some(shape) = policies.first() else {
        return assert!(blends.is_empty(), "a blend needs policies");
    };
    assert!(policies.iter().all(|p| p.same_shape(shape)), "blended policies have one shape");
    let known = |blend: &Blend| blend.terms().iter().all(|term| term.policy.index() < policies.len());
    assert!(blends.iter().all(|b| !b.terms().is_empty() && known(b)), "blends of these policies");
    assert_eq!(inputs.len(), blends.len() * shape.inputs(), "inputs of the batch");
    assert_eq!(out.len(), blends.len() * shape.outputs(), "outputs of the batch");
    scratch.order.clear();
    scratch.order.extend(blends.iter().zip(0..).map(|(blend, i)| (policies_used(blend), i)));
    scratch.order.sort_unstable();
    let order = core::mem::take(&mut scratch.order);
    for group in order.chunks(GROUP * BLOCK) {
        Group { policies, arithmetic, blends, members: group }.evaluate(inputs, scratch, out);
    }
    scratch.order = order;
}

/// One bit for each policy of the blend; policies beyond the 64th share bits, which costs time only.
fn policies_used(blend: &Blend) -> u64 {
    blend.terms().iter().fold(0, |set, term| set | 1u64.rotate_left(term.policy.index() as u32))
}

struct Group<'a> {
    policies: &'a [Mlp],
    arithmetic: Arithmetic,
    blends: &'a [Blend],
    members: &'a [(u64, u32)],
}

impl Group<'_> {
    fn evaluate(&self, inputs: &[f32], scratch: &mut BatchScratch, out: &mut [f32]) {
        // There are policies, lengths and shapes agree: the caller asserts it. A group has at most GROUP blocks.
        let shape = &self.policies[0];
        self.load_inputs(inputs, shape.inputs(), scratch);
        for layer in 0..shape.layers().len() {
            let blocks = self.members.len().div_ceil(BLOCK);
            scratch.y[..blocks * scratch.panels].fill([[0.0; TILE]; BLOCK]);
            for policy in 0..self.policies.len() {
                self.add_policy(policy, layer, scratch);
            }
            if layer + 1 < shape.layers().len() {
                Self::activate(blocks, scratch);
            }
        }
        for (at, &(_, character)) in self.members.iter().enumerate() {
            let panels = &scratch.y[at / BLOCK * scratch.panels..];
            let row = &mut out[character as usize * shape.outputs()..][..shape.outputs()];
            for (to, panel) in row.chunks_mut(TILE).zip(panels) {
                to.copy_from_slice(&panel[at % BLOCK][..to.len()]);
            }
        }
    }

    fn load_inputs(&self, inputs: &[f32], len: usize, scratch: &mut BatchScratch) {
        for (block, members) in self.members.chunks(BLOCK).enumerate() {
            let x = &mut scratch.x[block * scratch.width..][..len];
            // A short block repeats its first character, whose copies are never read.
            let rows: [&[f32]; BLOCK] = core::array::from_fn(|c| {
                let (_, character) = members.get(c).unwrap_or(&members[0]);
                &inputs[*character as usize * len..][..len]
            });
            for (i, x) in x.iter_mut().enumerate() {
                *x = core::array::from_fn(|c| rows[c][i]);
            }
        }
    }

    /// Adds one policy's part of a layer to the sums of every block that uses it.
    fn add_policy(&self, policy: usize, layer: usize, scratch: &mut BatchScratch) {
        let mut weights = [[0.0f32; BLOCK]; GROUP];
        let mut used = false;
        for (at, &(_, character)) in self.members.iter().enumerate() {
            let terms = self.blends[character as usize].active(layer).filter(|(p, _)| p.index() == policy);
            let weight: f32 = terms.map(|(_, w)| w).sum();
            weights[at / BLOCK][at % BLOCK] = weight;
            used |= weight != 0.0;
        }
        if !used {
            return;
        }
        let layer = &self.policies[policy].layers()[layer];
        let mut sums = [[0.0; TILE]; BLOCK];
        for (panel, rows) in layer.weight.chunks_exact(layer.inputs()).enumerate() {
            for (block, weights) in weights.iter().enumerate().filter(|(_, w)| **w != [0.0; BLOCK]) {
                let x = &scratch.x[block * scratch.width..][..layer.inputs()];
                self.arithmetic.block(x, rows, &layer.bias[panel], &mut sums);
                let y = &mut scratch.y[block * scratch.panels + panel];
                for ((y, sums), weight) in y.iter_mut().zip(&sums).zip(weights) {
                    for (y, sum) in y.iter_mut().zip(sums) {
                        *y += weight * sum;
                    }
                }
            }
        }
    }

    /// Cuts negative sums to zero and turns them into the inputs of the next layer.
    fn activate(blocks: usize, scratch: &mut BatchScratch) {
        for block in 0..blocks {
            for panel in 0..scratch.panels {
                let sums = &scratch.y[block * scratch.panels + panel];
                let x = &mut scratch.x[block * scratch.width + panel * TILE..][..TILE];
                for (lane, x) in x.iter_mut().enumerate() {
                    *x = core::array::from_fn(|c| sums[c][lane].max(0.0));
                }
            }
        }
    }
}
