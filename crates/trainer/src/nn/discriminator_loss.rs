//! Loss of a discriminator: binary cross-entropy on demonstrations and simulated states, plus a penalty on the
//! squared gradient at the demonstrations (AMP, Peng et al. 2021, equation 8).
//!
//! Between kinks a ReLU network is linear, so its gradient by the input is `g = W1 D1 W2 D2 .. wL` with the masks
//! `D` of the forward pass. The penalty's gradient by the parameters is one pass along the same chain.

use super::matrix::{Shape, Write, multiply, multiply_left_transposed, multiply_right_transposed};
use super::network::Network;
use super::pass::Pass;

/// `1 / (1 + exp(-x))`.
#[must_use]
pub fn sigmoid(x: f32) -> f32 {
    if x >= 0.0 { 1.0 / (1.0 + (-x).exp()) } else { x.exp() / (1.0 + x.exp()) }
}

/// `ln(1 + exp(x))` without overflow.
#[must_use]
pub fn softplus(x: f32) -> f32 {
    x.max(0.0) + (-x.abs()).exp().ln_1p()
}

/// Sums over the rows of a batch; divide by its size for means.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DiscriminatorLoss {
    /// Cross-entropy, both kinds of rows.
    pub cross_entropy: f64,
    /// Squared gradient by the input at the demonstrations.
    pub squared_gradient: f64,
    /// Rows told apart rightly.
    pub right: f64,
}

/// Buffers for one batch of demonstrations followed by as many simulated rows.
#[derive(Clone, Debug)]
pub struct DiscriminatorPass {
    pass: Pass,
    /// `v_l`: gradient by the input of layer `l`'s ReLU, `[rows][outputs of l]`.
    chain: Vec<Vec<f32>>,
    /// Gradient of the penalty by `g` and then by each `v_l`.
    chain_delta: Vec<Vec<f32>>,
    input_gradient: Vec<f32>,
}

impl DiscriminatorPass {
    /// Buffers for a discriminator of these sizes and at most `rows` demonstrations.
    #[must_use]
    pub fn new(sizes: &[usize], rows: usize) -> Self {
        let hidden = &sizes[1..sizes.len() - 1];
        let chain: Vec<Vec<f32>> = hidden.iter().map(|h| vec![0.0; rows * h]).collect();
        Self {
            pass: Pass::new(sizes, 2 * rows),
            chain_delta: chain.clone(),
            chain,
            input_gradient: vec![0.0; rows * sizes[0]],
        }
    }

    /// Adds the gradient of `(cross-entropy sum + penalty * squared gradient sum) * scale` to `gradient` and returns
    /// the sums. The first half of the rows of `input` are demonstrations, the rest simulated.
    ///
    /// # Panics
    /// When there are more rows than this was made for, an odd number, or the sizes differ.
    pub fn accumulate(
        &mut self,
        network: &Network,
        input: &[f32],
        penalty: f32,
        scale: f32,
        gradient: &mut [f32],
    ) -> DiscriminatorLoss {
        let rows = input.len() / network.inputs();
        let real = rows / 2;
        assert_eq!(rows, 2 * real, "as many demonstrations as simulated rows");
        self.pass.forward(network, None, input);
        let mut loss = DiscriminatorLoss::default();
        let (logits, delta) = self.pass.output_and_delta(rows);
        for (i, (logit, delta)) in logits.iter().zip(delta).enumerate() {
            let label = if i < real { 1.0 } else { 0.0 };
            loss.cross_entropy += f64::from(softplus(*logit) - label * logit);
            loss.right += f64::from(u8::from((*logit > 0.0) == (i < real)));
            *delta = (sigmoid(*logit) - label) * scale;
        }
        self.input_gradient(network, real);
        let g = &mut self.input_gradient[..real * network.inputs()];
        loss.squared_gradient = g.iter().map(|g| f64::from(*g) * f64::from(*g)).sum();
        g.iter_mut().for_each(|g| *g *= 2.0 * penalty * scale);
        self.penalty_gradient(network, real, gradient);
        self.pass.backward(network, None, input, gradient, None);
        loss
    }

    /// Gradient of the output by the input, for the first `rows` rows of the last forward pass.
    fn input_gradient(&mut self, network: &Network, rows: usize) {
        let layers = network.layers();
        for l in (0..layers.len() - 1).rev() {
            let above = &layers[l + 1];
            let weight = &network.parameters[above.weight.clone()];
            let (lower, upper) = self.chain.split_at_mut(l + 1);
            let v = &mut lower[l][..rows * above.inputs];
            if let Some(upper) = upper.first() {
                let shape = Shape { rows, inner: above.outputs, columns: above.inputs };
                multiply_right_transposed(v, Write::Replace, &upper[..rows * above.outputs], weight, shape);
            } else {
                v.chunks_exact_mut(above.inputs).for_each(|row| row.copy_from_slice(weight));
            }
            mask(v, self.pass.hidden(l, rows));
        }
        let first = &layers[0];
        let shape = Shape { rows, inner: first.outputs, columns: first.inputs };
        let (g, v) =
            (&mut self.input_gradient[..rows * first.inputs], &self.chain[0][..rows * first.outputs]);
        multiply_right_transposed(g, Write::Replace, v, &network.parameters[first.weight.clone()], shape);
    }

    /// Adds the penalty's gradient by the weights; `input_gradient` holds the penalty's gradient by `g`.
    fn penalty_gradient(&mut self, network: &Network, rows: usize, gradient: &mut [f32]) {
        let layers = network.layers();
        for (l, layer) in layers.iter().enumerate().take(layers.len() - 1) {
            let (lower, upper) = self.chain_delta.split_at_mut(l);
            let from = lower.last().map_or(&self.input_gradient[..], |d| &d[..]);
            let from = &from[..rows * layer.inputs];
            let v = &self.chain[l][..rows * layer.outputs];
            let shape = Shape { rows: layer.inputs, inner: rows, columns: layer.outputs };
            multiply_left_transposed(&mut gradient[layer.weight.clone()], Write::Add, from, v, shape);
            let to = &mut upper[0][..rows * layer.outputs];
            let shape = Shape { rows, inner: layer.inputs, columns: layer.outputs };
            multiply(to, Write::Replace, from, &network.parameters[layer.weight.clone()], shape);
            mask(to, self.pass.hidden(l, rows));
        }
        let last = &layers[layers.len() - 1];
        let from = &self.chain_delta[layers.len() - 2][..rows * last.inputs];
        for row in from.chunks_exact(last.inputs) {
            gradient[last.weight.clone()].iter_mut().zip(row).for_each(|(g, d)| *g += d);
        }
    }
}

fn mask(values: &mut [f32], hidden: &[f32]) {
    values.iter_mut().zip(hidden).for_each(|(v, h)| *v = if *h > 0.0 { *v } else { 0.0 });
}

#[cfg(test)]
#[path = "discriminator_loss_tests.rs"]
mod tests;
