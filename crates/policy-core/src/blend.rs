//! Interpolated policies: for every layer, the mixing factor of each policy.
//!
//! Interpolating parameters is linear in the parameters, so a layer of the interpolated network is the
//! weighted sum of the policies' layers: the blend is evaluated without being built (paper, section 3.3;
//! per layer, section 4.3).

use crate::ids::PolicyId;
use crate::kernel::{Arithmetic, add_scaled_rows, relu, scale_rows};
use crate::mlp::{MAX_LAYERS, Mlp, MlpScratch};

/// Most policies in one [`Blend`].
pub const MAX_BLEND_TERMS: usize = 16;

/// One policy's part in a blend.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BlendTerm {
    /// The policy among those the blend is evaluated with.
    pub policy: PolicyId,
    /// Blend weight in each layer, first to last; layers the policy lacks are ignored. Usually in [0, 1] with
    /// a sum of 1 over the terms, but any finite number extrapolates. A weight of 0 costs nothing.
    pub weights: [f32; MAX_LAYERS],
}

/// Blend weights of up to [`MAX_BLEND_TERMS`] policies.
#[derive(Clone, Copy, Debug, Default)]
pub struct Blend {
    terms: [BlendTerm; MAX_BLEND_TERMS],
    len: usize,
}

impl PartialEq for Blend {
    fn eq(&self, other: &Self) -> bool {
        self.terms() == other.terms()
    }
}

/// A [`Blend`] has no room for another policy.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("expected at most {MAX_BLEND_TERMS} policies in a blend")]
pub struct BlendFull;

impl Blend {
    /// One policy alone.
    #[must_use]
    pub fn single(policy: PolicyId) -> Self {
        let mut blend = Self::default();
        blend.terms[0] = BlendTerm { policy, weights: [1.0; MAX_LAYERS] };
        blend.len = 1;
        blend
    }

    /// `t` of the way from one policy to another in all layers: the paper's main mode.
    #[must_use]
    pub fn between(from: PolicyId, to: PolicyId, t: f32) -> Self {
        Self::between_per_layer(from, to, [t; MAX_LAYERS])
    }

    /// A way from one policy to another that differs from layer to layer: the paper's section 4.3.
    #[must_use]
    pub fn between_per_layer(from: PolicyId, to: PolicyId, t: [f32; MAX_LAYERS]) -> Self {
        if from == to || t == [0.0; MAX_LAYERS] {
            return Self::single(from);
        }
        if t == [1.0; MAX_LAYERS] {
            return Self::single(to);
        }
        let mut blend = Self::default();
        blend.terms[0] = BlendTerm { policy: from, weights: t.map(|t| 1.0 - t) };
        blend.terms[1] = BlendTerm { policy: to, weights: t };
        blend.len = 2;
        blend
    }

    /// Adds a policy.
    ///
    /// # Errors
    /// When the blend is full.
    pub fn push(&mut self, term: BlendTerm) -> Result<(), BlendFull> {
        let slot = self.terms.get_mut(self.len).ok_or(BlendFull)?;
        *slot = term;
        self.len += 1;
        Ok(())
    }

    /// Adds weights to those of a policy, which joins the blend where it has none.
    ///
    /// # Errors
    /// When the policy is not in the blend and the blend is full.
    pub(crate) fn add(&mut self, term: BlendTerm) -> Result<(), BlendFull> {
        match self.terms[..self.len].iter_mut().find(|other| other.policy == term.policy) {
            Some(other) => {
                for (weight, more) in other.weights.iter_mut().zip(term.weights) {
                    *weight += more;
                }
                Ok(())
            }
            None => self.push(term),
        }
    }

    /// The blend with a share of all of its weight given to one policy. Without room for it, as it is.
    pub(crate) fn with_share(self, policy: PolicyId, share: f32) -> Self {
        if share <= 0.0 {
            return self;
        }
        if share >= 1.0 {
            return Self::single(policy);
        }
        let mut shared = self;
        for term in &mut shared.terms[..shared.len] {
            term.weights = term.weights.map(|weight| (1.0 - share) * weight);
        }
        match shared.add(BlendTerm { policy, weights: [share; MAX_LAYERS] }) {
            Ok(()) => shared,
            Err(BlendFull) => self,
        }
    }

    /// The policies and their blend weights.
    #[must_use]
    pub fn terms(&self) -> &[BlendTerm] {
        &self.terms[..self.len]
    }

    /// The policy, if the blend is one policy alone with weight 1.
    #[must_use]
    pub fn as_single(&self) -> Option<PolicyId> {
        match self.terms() {
            [term] if term.weights == [1.0; MAX_LAYERS] => Some(term.policy),
            _ => None,
        }
    }

    /// The term with the greatest blend weight over all layers; `None` when the blend is empty.
    #[must_use]
    pub fn strongest(&self) -> Option<PolicyId> {
        let total = |t: &BlendTerm| t.weights.iter().sum::<f32>();
        let best = self.terms().iter().max_by(|a, b| total(a).total_cmp(&total(b)));
        best.map(|term| term.policy)
    }

    /// Terms with a weight other than 0 in `layer`.
    pub(crate) fn active(&self, layer: usize) -> impl Iterator<Item = (PolicyId, f32)> + '_ {
        self.terms().iter().map(move |t| (t.policy, t.weights[layer])).filter(|(_, w)| *w != 0.0)
    }

    /// Writes the outputs of the interpolated network to `out`, without building it: one product for each
    /// policy. Does not allocate. A blend of one policy gives that policy's outputs bit for bit.
    ///
    /// # Panics
    /// When the blend is empty or names a policy that is not there, when the shapes differ, or as
    /// [`Mlp::evaluate_into`].
    pub fn evaluate_into(
        &self,
        policies: &[Mlp],
        arithmetic: Arithmetic,
        input: &[f32],
        scratch: &mut MlpScratch,
        out: &mut [f32],
    ) {
        let first = &policies[self.terms()[0].policy.index()];
        if let Some(policy) = self.as_single() {
            return policies[policy.index()].evaluate_into(arithmetic, input, scratch, out);
        }
        first.assert_lengths(input, out);
        let MlpScratch { front, back, .. } = scratch;
        let mut x = input;
        let last = first.layers().len() - 1;
        for (i, shape) in first.layers().iter().enumerate() {
            let y = &mut front[..shape.padded_outputs()];
            y.fill(0.0);
            for (policy, weight) in self.active(i) {
                let layer = &policies[policy.index()].layers()[i];
                assert_eq!(layer.outputs(), shape.outputs(), "blended policies have one shape");
                arithmetic.layer_add(x, &layer.weight, &layer.bias, weight, y.as_chunks_mut().0);
            }
            if i < last {
                relu(y);
            }
            core::mem::swap(front, back);
            x = &back[..shape.outputs()];
        }
        out.copy_from_slice(x);
    }

    /// Writes the parameters of the interpolated network to `out`: worth it when the blend rests for some
    /// ticks. Does not allocate.
    ///
    /// # Panics
    /// When the blend is empty or names a policy that is not there, or when the shapes differ.
    pub fn parameters_into(&self, policies: &[Mlp], out: &mut Mlp) {
        assert!(policies[self.terms()[0].policy.index()].same_shape(out), "blended policies have one shape");
        for (i, layer) in out.layers_mut().iter_mut().enumerate() {
            let mut first = true;
            for (policy, weight) in self.active(i) {
                let source = &policies[policy.index()].layers()[i];
                let write = if first { scale_rows } else { add_scaled_rows };
                write(weight, &source.weight, &mut layer.weight);
                write(weight, &source.bias, &mut layer.bias);
                first = false;
            }
            if first {
                let shape = &policies[self.terms()[0].policy.index()].layers()[i];
                scale_rows(0.0, &shape.weight, &mut layer.weight);
                scale_rows(0.0, &shape.bias, &mut layer.bias);
            }
        }
    }

    /// Evaluates every policy of the blend and sums their outputs, each with its weight in the last
    /// layer: blending of actions, to compare. Does not allocate.
    ///
    /// # Panics
    /// As [`Blend::evaluate_into`].
    pub fn evaluate_actions_into(
        &self,
        policies: &[Mlp],
        arithmetic: Arithmetic,
        input: &[f32],
        scratch: &mut MlpScratch,
        out: &mut [f32],
    ) {
        let last = policies[self.terms()[0].policy.index()].layers().len() - 1;
        if let Some(policy) = self.as_single() {
            return policies[policy.index()].evaluate_into(arithmetic, input, scratch, out);
        }
        let mut outputs = core::mem::take(&mut scratch.outputs);
        let action = &mut outputs[..out.len()];
        out.fill(0.0);
        for (policy, weight) in self.active(last) {
            policies[policy.index()].evaluate_into(arithmetic, input, scratch, action);
            for (sum, a) in out.iter_mut().zip(&*action) {
                *sum += weight * a;
            }
        }
        scratch.outputs = outputs;
    }
}
