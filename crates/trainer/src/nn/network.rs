//! Parameters of a dense network in one vector: per layer the weights, input-major `[inputs][outputs]`, then the
//! biases. ReLU between layers, none after the last. One vector makes Adam, distances and checkpoints plain.

use std::ops::Range;

use random::Rng;

/// Sizes and parameters of a dense network.
#[derive(Clone, Debug, PartialEq)]
pub struct Network {
    sizes: Vec<usize>,
    /// All parameters, layer by layer, weights before biases.
    pub parameters: Vec<f32>,
}

/// Where a layer's numbers lie in [`Network::parameters`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LayerRange {
    /// Inputs of the layer.
    pub inputs: usize,
    /// Outputs of the layer.
    pub outputs: usize,
    /// Weights, `[inputs][outputs]`.
    pub weight: Range<usize>,
    /// Biases.
    pub bias: Range<usize>,
}

impl Network {
    /// A network with He-normal weights and zero biases; the last layer is scaled by `last_scale`.
    ///
    /// # Panics
    /// When there are fewer than two sizes.
    #[must_use]
    pub fn new(sizes: &[usize], last_scale: f32, rng: &mut Rng) -> Self {
        let mut network = Self::zeros(sizes);
        let layers = network.layers();
        for (i, layer) in layers.iter().enumerate() {
            let scale = if i + 1 == layers.len() { last_scale } else { 1.0 };
            let deviation = scale * (2.0 / layer.inputs as f32).sqrt();
            for value in &mut network.parameters[layer.weight.clone()] {
                *value = deviation * rng.normal();
            }
        }
        network
    }

    /// A network whose parameters are all zero.
    ///
    /// # Panics
    /// When there are fewer than two sizes.
    #[must_use]
    pub fn zeros(sizes: &[usize]) -> Self {
        assert!(sizes.len() >= 2, "a network has inputs and outputs");
        Self { sizes: sizes.to_vec(), parameters: vec![0.0; Self::parameter_count(sizes)] }
    }

    /// Number of parameters of a network with these sizes.
    #[must_use]
    pub fn parameter_count(sizes: &[usize]) -> usize {
        sizes.windows(2).map(|s| (s[0] + 1) * s[1]).sum()
    }

    /// Inputs, hidden sizes, outputs.
    #[must_use]
    pub fn sizes(&self) -> &[usize] {
        &self.sizes
    }

    /// Number of outputs.
    #[must_use]
    pub fn outputs(&self) -> usize {
        self.sizes[self.sizes.len() - 1]
    }

    /// Number of inputs.
    #[must_use]
    pub fn inputs(&self) -> usize {
        self.sizes[0]
    }

    /// The layers in order.
    #[must_use]
    pub fn layers(&self) -> Vec<LayerRange> {
        layer_ranges(&self.sizes)
    }

    /// Squared Euclidean distance to the parameters of `other`.
    #[must_use]
    pub fn squared_distance(&self, other: &Network) -> f64 {
        let pairs = self.parameters.iter().zip(&other.parameters);
        pairs.map(|(a, b)| (f64::from(*a) - f64::from(*b)).powi(2)).sum()
    }
}

/// The layers of a network with these sizes.
pub(super) fn layer_ranges(sizes: &[usize]) -> Vec<LayerRange> {
    let mut at = 0;
    let mut layers = Vec::with_capacity(sizes.len().saturating_sub(1));
    for s in sizes.windows(2) {
        let weight = at..at + s[0] * s[1];
        let bias = weight.end..weight.end + s[1];
        at = bias.end;
        layers.push(LayerRange { inputs: s[0], outputs: s[1], weight, bias });
    }
    layers
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_fill_the_vector() {
        let network = Network::new(&[225, 128, 32, 28], 0.01, &mut Rng::new(1, 0));
        let layers = network.layers();
        assert_eq!(layers.last().unwrap().bias.end, network.parameters.len());
        assert_eq!(network.parameters.len(), 225 * 128 + 128 + 128 * 32 + 32 + 32 * 28 + 28);
        let last = &network.parameters[layers[2].weight.clone()];
        assert!(last.iter().all(|w| w.abs() < 0.02));
    }

    #[test]
    fn distance_is_squared() {
        let mut a = Network::zeros(&[2, 1]);
        let b = a.clone();
        a.parameters[0] = 3.0;
        assert_eq!(a.squared_distance(&b), 9.0);
    }
}
