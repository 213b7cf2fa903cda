//! The inner loops: one dense layer for one character, and for a block of characters.
//!
//! Parameters lie in panels of [`TILE`] outputs, input-major, so that a panel streams through the
//! cache once while its outputs stay in registers. Each output sums its inputs in one fixed order that no
//! vector width changes; without fused multiply-add ([`Arithmetic::Reproducible`]) the bits are the same
//! on every machine.

#![expect(clippy::needless_range_loop, reason = "index loops over fixed arrays are what vectorises")]

use multiversion::multiversion;
use multiversion::target::target_cfg_f;

/// Outputs of one panel.
pub(crate) const TILE: usize = 32;

/// Characters of one block of a batch.
pub(crate) const BLOCK: usize = 6;

/// Outputs a block keeps in registers at once.
const HALF: usize = TILE / 2;

/// How products are summed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Arithmetic {
    /// Separate multiplication and addition in a fixed order: the same bits on every machine.
    #[default]
    Reproducible,
    /// Fused multiply-add where the processor has it: differs in the last bits between machines. One
    /// evaluation is bound by memory and gains nothing; a batch does.
    Fused,
}

/// One input's parameters to the outputs of a panel, or the panel's biases, or activations.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub(crate) struct Row(pub(crate) [f32; TILE]);

impl Row {
    pub(crate) const ZERO: Row = Row([0.0; TILE]);
}

#[inline(always)]
fn multiply_add<const FUSED: bool>(a: f32, b: f32, sum: f32) -> f32 {
    #[cfg(feature = "std")]
    if FUSED {
        return f32::mul_add(a, b, sum);
    }
    a * b + sum
}

/// `bias + x * weight` of one panel.
#[inline(always)]
fn panel<const FUSED: bool>(x: &[f32], weight: &[Row], bias: &Row) -> [f32; TILE] {
    let mut sum = bias.0;
    for (&x, row) in x.iter().zip(weight) {
        for k in 0..TILE {
            sum[k] = multiply_add::<FUSED>(x, row.0[k], sum[k]);
        }
    }
    sum
}

/// `bias + x * weight` of two panels at once: twice as many sums hide the latency of the addition.
#[inline(always)]
fn panel_pair<const FUSED: bool>(x: &[f32], weight: [&[Row]; 2], bias: [&Row; 2]) -> [[f32; TILE]; 2] {
    let (mut left, mut right) = (bias[0].0, bias[1].0);
    for ((&x, l), r) in x.iter().zip(weight[0]).zip(weight[1]) {
        for k in 0..TILE {
            left[k] = multiply_add::<FUSED>(x, l.0[k], left[k]);
        }
        for k in 0..TILE {
            right[k] = multiply_add::<FUSED>(x, r.0[k], right[k]);
        }
    }
    [left, right]
}

/// Calls `write` with the index and the sums of every panel.
#[inline(always)]
fn for_each_panel<const FUSED: bool>(
    x: &[f32],
    weight: &[Row],
    bias: &[Row],
    mut write: impl FnMut(usize, &[f32; TILE]),
) {
    // `Layer` is made with a weight row for each input and panel; `Mlp` passes as many inputs, and room for all panels.
    let rows = x.len();
    let mut at = 0;
    while at + 2 <= bias.len() {
        let (left, right) = weight[at * rows..(at + 2) * rows].split_at(rows);
        let [l, r] = panel_pair::<FUSED>(x, [left, right], [&bias[at], &bias[at + 1]]);
        write(at, &l);
        write(at + 1, &r);
        at += 2;
    }
    if at < bias.len() {
        write(at, &panel::<FUSED>(x, &weight[at * rows..(at + 1) * rows], &bias[at]));
    }
}

#[inline(always)]
fn layer<const FUSED: bool>(x: &[f32], weight: &[Row], bias: &[Row], out: &mut [[f32; TILE]]) {
    for_each_panel::<FUSED>(x, weight, bias, |at, sums| out[at] = *sums);
}

/// Adds `factor` times the layer to `out`.
#[inline(always)]
fn layer_add<const FUSED: bool>(
    x: &[f32],
    weight: &[Row],
    bias: &[Row],
    factor: f32,
    out: &mut [[f32; TILE]],
) {
    for_each_panel::<FUSED>(x, weight, bias, |at, sums| {
        for k in 0..TILE {
            out[at][k] += factor * sums[k];
        }
    });
}

/// One panel for a block of characters: `x[i]` holds input i of all of them.
#[inline(always)]
fn block_panel<const FUSED: bool>(
    x: &[[f32; BLOCK]],
    weight: &[Row],
    bias: &Row,
    out: &mut [[f32; TILE]; BLOCK],
) {
    for half in 0..2 {
        let from = half * HALF;
        let mut sums = [[0.0f32; HALF]; BLOCK];
        for sum in &mut sums {
            sum.copy_from_slice(&bias.0[from..from + HALF]);
        }
        for (x, row) in x.iter().zip(weight) {
            let row: [f32; HALF] = core::array::from_fn(|k| row.0[from + k]);
            for c in 0..BLOCK {
                for k in 0..HALF {
                    sums[c][k] = multiply_add::<FUSED>(x[c], row[k], sums[c][k]);
                }
            }
        }
        for (out, sum) in out.iter_mut().zip(&sums) {
            out[from..from + HALF].copy_from_slice(sum);
        }
    }
}

macro_rules! dispatched {
    ($fused:ident, $plain:ident, $body:ident, ($($arg:ident: $ty:ty),*) $(-> $ret:ty)?) => {
        #[multiversion(targets("x86_64+avx2+fma"))]
        fn $fused($($arg: $ty),*) $(-> $ret)? {
            if target_cfg_f!(target_feature = "fma") || cfg!(target_arch = "aarch64") {
                $body::<true>($($arg),*)
            } else {
                $body::<false>($($arg),*)
            }
        }
        #[multiversion(targets("x86_64+avx2"))]
        fn $plain($($arg: $ty),*) $(-> $ret)? {
            $body::<false>($($arg),*)
        }
    };
}

/// `to = factor * from`, or `to += factor * from`.
#[inline(always)]
fn scaled<const ADD: bool>(factor: f32, from: &[Row], to: &mut [Row]) {
    for (to, from) in to.iter_mut().zip(from) {
        for k in 0..TILE {
            to.0[k] = if ADD { to.0[k] + factor * from.0[k] } else { factor * from.0[k] };
        }
    }
}

dispatched!(layer_fused, layer_plain, layer, (x: &[f32], weight: &[Row], bias: &[Row], out: &mut [[f32; TILE]]));
dispatched!(
    layer_add_fused, layer_add_plain, layer_add,
    (x: &[f32], weight: &[Row], bias: &[Row], factor: f32, out: &mut [[f32; TILE]])
);
dispatched!(
    block_fused, block_plain, block_panel,
    (x: &[[f32; BLOCK]], weight: &[Row], bias: &Row, out: &mut [[f32; TILE]; BLOCK])
);

/// `to = factor * from`: one policy's part of a layer's interpolated parameters.
#[multiversion(targets("x86_64+avx2"))]
pub(crate) fn scale_rows(factor: f32, from: &[Row], to: &mut [Row]) {
    scaled::<false>(factor, from, to);
}

/// `to += factor * from`.
#[multiversion(targets("x86_64+avx2"))]
pub(crate) fn add_scaled_rows(factor: f32, from: &[Row], to: &mut [Row]) {
    scaled::<true>(factor, from, to);
}

impl Arithmetic {
    /// `out = bias + x * weight`.
    pub(crate) fn layer(self, x: &[f32], weight: &[Row], bias: &[Row], out: &mut [[f32; TILE]]) {
        match self {
            Arithmetic::Reproducible => layer_plain(x, weight, bias, out),
            Arithmetic::Fused => layer_fused(x, weight, bias, out),
        }
    }

    /// `out += factor * (bias + x * weight)`.
    pub(crate) fn layer_add(
        self,
        x: &[f32],
        weight: &[Row],
        bias: &[Row],
        factor: f32,
        out: &mut [[f32; TILE]],
    ) {
        match self {
            Arithmetic::Reproducible => layer_add_plain(x, weight, bias, factor, out),
            Arithmetic::Fused => layer_add_fused(x, weight, bias, factor, out),
        }
    }

    /// `out[c] = bias + x[..][c] * weight` of one panel for each character c of a block.
    pub(crate) fn block(
        self,
        x: &[[f32; BLOCK]],
        weight: &[Row],
        bias: &Row,
        out: &mut [[f32; TILE]; BLOCK],
    ) {
        match self {
            Arithmetic::Reproducible => block_plain(x, weight, bias, out),
            Arithmetic::Fused => block_fused(x, weight, bias, out),
        }
    }
}

/// Cuts negative activations to zero; NaN becomes zero as well.
pub(crate) fn relu(activations: &mut [f32]) {
    for value in activations {
        *value = value.max(0.0);
    }
}
