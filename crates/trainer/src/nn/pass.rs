//! Forward and backward pass of a [`Network`] over a batch of rows, alone or blended with another.
//!
//! Blended, every layer is `y = (1 - t) (P x + p) + t (C x + c)` with a blend weight `t` per row: the network on the
//! straight line between parent and child, without building it. The gradient goes to the child, and to the parent where
//! it learns too.

use super::matrix::{Shape, Write, multiply, multiply_left_transposed, multiply_right_transposed};
use super::network::{LayerRange, Network, layer_ranges};

/// Activations and gradients of up to a fixed number of rows.
#[derive(Clone, Debug)]
pub struct Pass {
    layers: Vec<LayerRange>,
    rows: usize,
    /// Output of every layer after its ReLU, `[rows][outputs]`.
    outputs: Vec<Vec<f32>>,
    /// Gradient of the loss by the output of every layer, before its ReLU.
    deltas: Vec<Vec<f32>>,
    scratch: Vec<f32>,
    share: Vec<f32>,
}

/// A parent and the blend weight of the child in every row.
#[derive(Clone, Copy, Debug)]
pub struct Line<'a> {
    /// The network at blend weight 0; same sizes as the child.
    pub parent: &'a Network,
    /// One blend weight per row, 0 parent to 1 child.
    pub blend: &'a [f32],
}

impl Pass {
    /// Buffers for networks of these sizes and at most `rows` rows.
    #[must_use]
    pub fn new(sizes: &[usize], rows: usize) -> Self {
        let layers = layer_ranges(sizes);
        let buffers: Vec<Vec<f32>> = layers.iter().map(|l| vec![0.0; rows * l.outputs]).collect();
        let widest = layers.iter().map(|l| l.outputs.max(l.inputs)).max().unwrap_or(0);
        let scratch = vec![0.0; rows * widest];
        Self { layers, rows, outputs: buffers.clone(), deltas: buffers, share: scratch.clone(), scratch }
    }

    /// Output of the last forward pass of `rows` rows.
    #[must_use]
    pub fn output(&self, rows: usize) -> &[f32] {
        let last = self.layers.len() - 1;
        &self.outputs[last][..rows * self.layers[last].outputs]
    }

    /// The gradient by the output, for the caller to fill before [`Pass::backward`], beside the output itself.
    pub fn output_and_delta(&mut self, rows: usize) -> (&[f32], &mut [f32]) {
        let last = self.layers.len() - 1;
        let len = rows * self.layers[last].outputs;
        (&self.outputs[last][..len], &mut self.deltas[last][..len])
    }

    /// Output of hidden layer `layer` after its ReLU.
    pub(super) fn hidden(&self, layer: usize, rows: usize) -> &[f32] {
        &self.outputs[layer][..rows * self.layers[layer].outputs]
    }

    /// Evaluates `network` on `input`, `[rows][inputs]`.
    ///
    /// # Panics
    /// When the network has other sizes, or there are more rows, than this pass was made for.
    pub fn forward(&mut self, network: &Network, line: Option<Line<'_>>, input: &[f32]) {
        let rows = self.check(network, input);
        for (i, layer) in self.layers.iter().enumerate() {
            let (before, after) = self.outputs.split_at_mut(i);
            let x = before.last().map_or(input, |b| &b[..rows * layer.inputs]);
            let y = &mut after[0][..rows * layer.outputs];
            affine(network, layer, x, y);
            if let Some(Line { parent, blend }) = line {
                let z = &mut self.scratch[..rows * layer.outputs];
                affine(parent, layer, x, z);
                let pairs = y.chunks_exact_mut(layer.outputs).zip(z.chunks_exact(layer.outputs));
                for ((y, z), &t) in pairs.zip(blend) {
                    y.iter_mut().zip(z).for_each(|(y, z)| *y = t * *y + (1.0 - t) * z);
                }
            }
            if i + 1 < self.layers.len() {
                y.iter_mut().for_each(|v| *v = v.max(0.0));
            }
        }
    }

    /// Adds the gradient by the parameters of `network` to `gradient`, from the gradient by the output that the
    /// caller wrote through [`Pass::output_and_delta`]; that by the parent's parameters to `parent_gradient` if there is
    /// a line and the parent learns. Takes the same arguments as the forward pass before it.
    ///
    /// # Panics
    /// As [`Pass::forward`], and when a gradient is not as long as the parameters.
    pub fn backward(
        &mut self,
        network: &Network,
        line: Option<Line<'_>>,
        input: &[f32],
        gradient: &mut [f32],
        mut parent_gradient: Option<&mut [f32]>,
    ) {
        let rows = self.check(network, input);
        assert_eq!(gradient.len(), network.parameters.len(), "gradient of a network");
        let same = parent_gradient.as_ref().is_none_or(|g| g.len() == network.parameters.len());
        assert!(same, "gradient of a parent");
        for i in (0..self.layers.len()).rev() {
            let layer = &self.layers[i];
            let (before, after) = self.deltas.split_at_mut(i);
            let delta = &mut after[0][..rows * layer.outputs];
            let below = before.last_mut().map(|b| &mut b[..rows * layer.inputs]);
            let x = if i == 0 { input } else { &self.outputs[i - 1][..rows * layer.inputs] };
            // The parent's share goes its way before the blend weight scales this layer's gradient to the child's.
            if let Some(Line { parent, blend }) = line {
                let share = &mut self.share[..rows * layer.outputs];
                for ((share, delta), &t) in share
                    .chunks_exact_mut(layer.outputs)
                    .zip(delta.chunks_exact_mut(layer.outputs))
                    .zip(blend)
                {
                    for (s, d) in share.iter_mut().zip(delta) {
                        (*s, *d) = ((1.0 - t) * *d, t * *d);
                    }
                }
                if let Some(gradient) = parent_gradient.as_deref_mut() {
                    add_layer_gradient(gradient, layer, x, share);
                }
                if i > 0 {
                    let part = &mut self.scratch[..rows * layer.inputs];
                    let w = &parent.parameters[layer.weight.clone()];
                    multiply_right_transposed(part, Write::Replace, share, w, down(rows, layer));
                }
            }
            add_layer_gradient(gradient, layer, x, delta);
            if let Some(below) = below {
                let w = &network.parameters[layer.weight.clone()];
                multiply_right_transposed(below, Write::Replace, delta, w, down(rows, layer));
                if line.is_some() {
                    below.iter_mut().zip(&self.scratch).for_each(|(b, s)| *b += s);
                }
                below.iter_mut().zip(x).for_each(|(b, x)| *b = if *x > 0.0 { *b } else { 0.0 });
            }
        }
    }

    fn check(&self, network: &Network, input: &[f32]) -> usize {
        let rows = input.len() / self.layers[0].inputs;
        assert_eq!(input.len(), rows * self.layers[0].inputs, "input of a pass");
        assert!(rows <= self.rows, "expected at most {} rows, found {rows}", self.rows);
        debug_assert_eq!(network.layers(), self.layers);
        rows
    }
}

fn down(rows: usize, layer: &LayerRange) -> Shape {
    Shape { rows, inner: layer.outputs, columns: layer.inputs }
}

/// `y = x W + b` for every row.
fn affine(network: &Network, layer: &LayerRange, x: &[f32], y: &mut [f32]) {
    let bias = &network.parameters[layer.bias.clone()];
    y.chunks_exact_mut(layer.outputs).for_each(|row| row.copy_from_slice(bias));
    let shape = Shape { rows: y.len() / layer.outputs, inner: layer.inputs, columns: layer.outputs };
    multiply(y, Write::Add, x, &network.parameters[layer.weight.clone()], shape);
}

/// Adds `x^T delta` to the gradient of the weights and the column sums of `delta` to that of the biases.
fn add_layer_gradient(gradient: &mut [f32], layer: &LayerRange, x: &[f32], delta: &[f32]) {
    let shape = Shape { rows: layer.inputs, inner: delta.len() / layer.outputs, columns: layer.outputs };
    multiply_left_transposed(&mut gradient[layer.weight.clone()], Write::Add, x, delta, shape);
    for row in delta.chunks_exact(layer.outputs) {
        gradient[layer.bias.clone()].iter_mut().zip(row).for_each(|(g, d)| *g += d);
    }
}

#[cfg(test)]
#[path = "pass_tests.rs"]
mod tests;
