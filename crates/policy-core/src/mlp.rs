//! A policy or discriminator: a multilayer perceptron, ReLU between its layers.

use alloc::vec::Vec;

use crate::kernel::{Arithmetic, Row, TILE, relu};

/// Most layers an [`Mlp`] may have.
pub const MAX_LAYERS: usize = 4;

/// Widest layer an [`Mlp`] may have.
pub const MAX_WIDTH: usize = 4096;

/// Why a layer or an [`Mlp`] can't be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MlpError {
    /// A layer has no input or output, or too many.
    #[error("expected 1 to {MAX_WIDTH} inputs and outputs, found {inputs} and {outputs}")]
    Width {
        /// Inputs of the layer.
        inputs: usize,
        /// Outputs of the layer.
        outputs: usize,
    },
    /// The numbers don't fill the layer.
    #[error("expected {expected} numbers in the {what}, found {found}")]
    Count {
        /// `weight` or `bias`.
        what: &'static str,
        /// Numbers the shape asks for.
        expected: usize,
        /// Numbers given.
        found: usize,
    },
    /// A parameter is not finite.
    #[error("expected finite parameters, found {found} in the {what} at index {index}")]
    NotFinite {
        /// `weight` or `bias`.
        what: &'static str,
        /// Index in the given slice.
        index: usize,
        /// The number.
        found: f32,
    },
    /// Too few or too many layers.
    #[error("expected 1 to {MAX_LAYERS} layers, found {found}")]
    LayerCount {
        /// Layers given.
        found: usize,
    },
    /// A layer does not take what the one before gives.
    #[error(
        "expected layer {layer} to take the {expected} outputs of the layer before, found {found} inputs"
    )]
    Chain {
        /// Index of the layer.
        layer: usize,
        /// Outputs of the layer before.
        expected: usize,
        /// Its inputs.
        found: usize,
    },
}

/// One dense layer `y = x * weight + bias`; `weight` is `[inputs, outputs]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    inputs: usize,
    outputs: usize,
    /// Panels of [`TILE`] outputs, each with one row for every input; padded with zeros.
    pub(crate) weight: Vec<Row>,
    pub(crate) bias: Vec<Row>,
}

impl Layer {
    /// A layer from input-major weights: the parameters of input 0 to all outputs come first.
    ///
    /// # Errors
    /// When a width, a count or a number is not as [`MlpError`] says.
    pub fn from_input_major(
        inputs: usize,
        outputs: usize,
        weight: &[f32],
        bias: &[f32],
    ) -> Result<Self, MlpError> {
        if !(1..=MAX_WIDTH).contains(&inputs) || !(1..=MAX_WIDTH).contains(&outputs) {
            return Err(MlpError::Width { inputs, outputs });
        }
        for (what, numbers, expected) in [("weight", weight, inputs * outputs), ("bias", bias, outputs)] {
            if numbers.len() != expected {
                return Err(MlpError::Count { what, expected, found: numbers.len() });
            }
            if let Some(index) = numbers.iter().position(|n| !n.is_finite()) {
                // `position` found the index.
                return Err(MlpError::NotFinite { what, index, found: numbers[index] });
            }
        }
        let panels = outputs.div_ceil(TILE);
        let mut layer = Self {
            inputs,
            outputs,
            weight: alloc::vec![Row::ZERO; panels * inputs],
            bias: alloc::vec![Row::ZERO; panels],
        };
        for output in 0..outputs {
            let (panel, lane) = (output / TILE, output % TILE);
            // As many numbers as the sizes say, checked above; `panel` is below `outputs / TILE` rounded up.
            layer.bias[panel].0[lane] = bias[output];
            for input in 0..inputs {
                layer.weight[panel * inputs + input].0[lane] = weight[input * outputs + output];
            }
        }
        Ok(layer)
    }

    /// Number of inputs.
    #[must_use]
    pub fn inputs(&self) -> usize {
        self.inputs
    }

    /// Number of outputs.
    #[must_use]
    pub fn outputs(&self) -> usize {
        self.outputs
    }

    /// Outputs rounded up to whole panels.
    pub(crate) fn padded_outputs(&self) -> usize {
        self.bias.len() * TILE
    }

    /// Weights, input-major, as [`Layer::from_input_major`] takes them.
    pub fn weight(&self) -> impl Iterator<Item = f32> + '_ {
        (0..self.inputs).flat_map(move |input| {
            // As in `from_input_major`: a panel has a row for every input.
            (0..self.outputs)
                .map(move |output| self.weight[output / TILE * self.inputs + input].0[output % TILE])
        })
    }

    /// Biases.
    pub fn bias(&self) -> impl Iterator<Item = f32> + '_ {
        self.bias.iter().flat_map(|row| row.0).take(self.outputs)
    }

    /// All parameters, padding included (it is zero in every layer).
    fn rows(&self) -> impl Iterator<Item = &Row> {
        self.weight.iter().chain(&self.bias)
    }
}

/// A multilayer perceptron, ReLU between its layers. Immutable; share it between characters.
///
/// ```
/// use policy_core::training::{Layer, MlpError};
/// use policy_core::{Arithmetic, Mlp, MlpScratch};
/// let hidden = Layer::from_input_major(1, 2, &[1.0, -1.0], &[0.0, 0.0])?;
/// let output = Layer::from_input_major(2, 1, &[1.0, 1.0], &[0.5])?;
/// let absolute_plus_half = Mlp::from_layers(vec![hidden, output])?;
/// let mut scratch = MlpScratch::for_mlp(&absolute_plus_half);
/// let mut y = [0.0];
/// absolute_plus_half.evaluate_into(Arithmetic::Reproducible, &[-3.0], &mut scratch, &mut y);
/// assert_eq!(y, [3.5]);
/// # Ok::<(), MlpError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Mlp {
    layers: Vec<Layer>,
}

impl Mlp {
    /// A network of the given layers, first to last.
    ///
    /// # Errors
    /// When there are too few or too many layers, or one does not take what the one before gives.
    pub fn from_layers(layers: Vec<Layer>) -> Result<Self, MlpError> {
        if !(1..=MAX_LAYERS).contains(&layers.len()) {
            return Err(MlpError::LayerCount { found: layers.len() });
        }
        for (i, pair) in layers.windows(2).enumerate() {
            if pair[0].outputs != pair[1].inputs {
                return Err(MlpError::Chain {
                    layer: i + 1,
                    expected: pair[0].outputs,
                    found: pair[1].inputs,
                });
            }
        }
        Ok(Self { layers })
    }

    /// Layers, first to last.
    #[must_use]
    pub fn layers(&self) -> &[Layer] {
        &self.layers
    }

    pub(crate) fn layers_mut(&mut self) -> &mut [Layer] {
        &mut self.layers
    }

    /// Numbers it takes.
    #[must_use]
    pub fn inputs(&self) -> usize {
        // `from_layers` refuses a network without layers, here and below.
        self.layers[0].inputs
    }

    /// Numbers it gives.
    #[must_use]
    pub fn outputs(&self) -> usize {
        self.layers[self.layers.len() - 1].outputs
    }

    /// Number of parameters.
    #[must_use]
    pub fn parameter_count(&self) -> usize {
        self.layers.iter().map(|l| (l.inputs + 1) * l.outputs).sum()
    }

    /// Multiply-adds of one evaluation.
    #[must_use]
    pub fn multiply_adds(&self) -> usize {
        self.layers.iter().map(|l| l.inputs * l.outputs).sum()
    }

    /// True when `other` has the same layers, so that the two can be blended.
    #[must_use]
    pub fn same_shape(&self, other: &Mlp) -> bool {
        self.layers.len() == other.layers.len()
            && self
                .layers
                .iter()
                .zip(&other.layers)
                .all(|(a, b)| a.inputs == b.inputs && a.outputs == b.outputs)
    }

    /// Squared Euclidean distance between the parameters of two networks: what the regularisation towards
    /// a parent holds small, and the cost of an edge in graph search.
    ///
    /// # Panics
    /// When the shapes differ.
    #[must_use]
    pub fn squared_distance(&self, other: &Mlp) -> f64 {
        assert!(self.same_shape(other), "only networks of one shape have a distance");
        let layers = self.layers.iter().zip(&other.layers);
        let rows = layers.flat_map(|(a, b)| a.rows().zip(b.rows()));
        rows.flat_map(|(a, b)| a.0.iter().zip(&b.0)).map(|(a, b)| f64::from(a - b) * f64::from(a - b)).sum()
    }

    /// Writes the network's outputs to `out`. Does not allocate.
    ///
    /// # Panics
    /// When `input` or `out` has the wrong length, or `scratch` was made for narrower networks.
    pub fn evaluate_into(
        &self,
        arithmetic: Arithmetic,
        input: &[f32],
        scratch: &mut MlpScratch,
        out: &mut [f32],
    ) {
        self.assert_lengths(input, out);
        let MlpScratch { front, back, .. } = scratch;
        let mut x = input;
        // Layers form a chain, so `x` fits each; `padded_outputs` is a whole number of panels.
        for (i, layer) in self.layers.iter().enumerate() {
            let y = &mut front[..layer.padded_outputs()];
            arithmetic.layer(x, &layer.weight, &layer.bias, y.as_chunks_mut().0);
            if i + 1 < self.layers.len() {
                relu(y);
            }
            core::mem::swap(front, back);
            x = &back[..layer.outputs];
        }
        out.copy_from_slice(x);
    }

    pub(crate) fn assert_lengths(&self, input: &[f32], out: &[f32]) {
        assert_eq!(input.len(), self.inputs(), "inputs of the network");
        assert_eq!(out.len(), self.outputs(), "outputs of the network");
    }
}

/// Room for the activations of one evaluation; owned by the caller and used again.
#[derive(Clone, Debug)]
pub struct MlpScratch {
    pub(crate) front: Vec<f32>,
    pub(crate) back: Vec<f32>,
    /// Outputs of one policy of several.
    pub(crate) outputs: Vec<f32>,
}

impl MlpScratch {
    /// Room for `mlp` and every network whose layers are no wider.
    #[must_use]
    pub fn for_mlp(mlp: &Mlp) -> Self {
        let width = mlp.layers.iter().map(Layer::padded_outputs).max().unwrap_or(0);
        let zeros = || alloc::vec![0.0; width];
        Self { front: zeros(), back: zeros(), outputs: zeros() }
    }
}
