//! Adam (Kingma and Ba 2015), with decoupled weight decay and clipping of the gradient's norm.

/// Moments of one parameter vector.
#[derive(Clone, Debug, PartialEq)]
pub struct Adam {
    /// Running mean of the gradient.
    pub mean: Vec<f32>,
    /// Running mean of the squared gradient.
    pub square: Vec<f32>,
    /// Steps taken.
    pub steps: u64,
}

const MEAN_DECAY: f32 = 0.9;
const SQUARE_DECAY: f32 = 0.999;
const EPSILON: f32 = 1e-8;

impl Adam {
    /// Moments of `len` parameters, no step taken.
    #[must_use]
    pub fn new(len: usize) -> Self {
        Self { mean: vec![0.0; len], square: vec![0.0; len], steps: 0 }
    }

    /// Moves `parameters` against `gradient`; `decay` pulls them to zero by `rate * decay` of their size.
    ///
    /// # Panics
    /// When the lengths differ.
    pub fn step(&mut self, parameters: &mut [f32], gradient: &[f32], rate: f32, decay: f32) {
        assert_eq!(parameters.len(), self.mean.len(), "parameters of Adam");
        assert_eq!(gradient.len(), self.mean.len(), "gradient of Adam");
        self.steps += 1;
        let steps = self.steps.min(1_000_000) as f32;
        let mean_scale = rate / (1.0 - MEAN_DECAY.powf(steps));
        let square_scale = 1.0 / (1.0 - SQUARE_DECAY.powf(steps));
        let keep = 1.0 - rate * decay;
        let moments = self.mean.iter_mut().zip(self.square.iter_mut());
        for ((p, g), (m, s)) in parameters.iter_mut().zip(gradient).zip(moments) {
            *m = MEAN_DECAY * *m + (1.0 - MEAN_DECAY) * g;
            *s = SQUARE_DECAY * *s + (1.0 - SQUARE_DECAY) * g * g;
            *p = *p * keep - mean_scale * *m / ((*s * square_scale).sqrt() + EPSILON);
        }
    }
}

/// Scales `gradient` down so that its Euclidean norm is at most `limit`; returns the norm it had.
pub fn clip_norm(gradient: &mut [f32], limit: f32) -> f32 {
    let norm = gradient.iter().map(|g| f64::from(*g) * f64::from(*g)).sum::<f64>().sqrt() as f32;
    if norm > limit {
        let scale = limit / norm;
        gradient.iter_mut().for_each(|g| *g *= scale);
    }
    norm
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_step_has_the_length_of_the_rate() {
        let mut adam = Adam::new(2);
        let mut p = [1.0, -1.0];
        adam.step(&mut p, &[0.3, -50.0], 0.01, 0.0);
        assert!((p[0] - 0.99).abs() < 1e-6 && (p[1] + 0.99).abs() < 1e-6, "{p:?}");
    }

    #[test]
    fn it_finds_the_bottom_of_a_bowl() {
        let mut adam = Adam::new(2);
        let mut p = [3.0, -2.0];
        for _ in 0..4000 {
            let g = [2.0 * (p[0] - 1.0), 20.0 * (p[1] - 0.5)];
            adam.step(&mut p, &g, 0.01, 0.0);
        }
        assert!((p[0] - 1.0).abs() < 1e-3 && (p[1] - 0.5).abs() < 1e-3, "{p:?}");
    }

    #[test]
    fn decay_alone_shrinks() {
        let mut adam = Adam::new(1);
        let mut p = [1.0];
        adam.step(&mut p, &[0.0], 0.1, 0.5);
        assert!((p[0] - 0.95).abs() < 1e-6);
    }

    #[test]
    fn a_long_gradient_is_clipped_and_a_short_one_kept() {
        let mut g = [3.0, 4.0];
        assert_eq!(clip_norm(&mut g, 10.0), 5.0);
        assert_eq!(g, [3.0, 4.0]);
        assert_eq!(clip_norm(&mut g, 1.0), 5.0);
        assert!((g[0] - 0.6).abs() < 1e-6);
    }
}
