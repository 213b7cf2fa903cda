//! What training and evaluation draw at random: numbers ([`Rng`]), and how characters lie that are dropped limp ([`limp`]).
//!
//! Each character and each learner has a small generator of its own. A run depends on its seed and not on how threads
//! share the work. The generator is PCG-32 (O'Neill 2014).

pub mod limp;

use serde::{Deserialize, Serialize};

/// A PCG-32 generator. Its two words are its whole state and go into checkpoints.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Rng {
    state: u64,
    stream: u64,
}

impl Rng {
    /// A generator for `seed`; different streams of one seed do not overlap.
    #[must_use]
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut rng = Self { state: 0, stream: (stream << 1) | 1 };
        rng.next_u32();
        rng.state = rng.state.wrapping_add(seed);
        rng.next_u32();
        rng
    }

    /// 32 random bits.
    pub fn next_u32(&mut self) -> u32 {
        let old = self.state;
        self.state = old.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(self.stream);
        let shifted = (((old >> 18) ^ old) >> 27) as u32;
        shifted.rotate_right((old >> 59) as u32)
    }

    /// Uniform in [0, 1).
    pub fn uniform(&mut self) -> f32 {
        (self.next_u32() >> 8) as f32 * (1.0 / 16_777_216.0)
    }

    /// Uniform in [low, high).
    pub fn range(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.uniform()
    }

    /// Uniform in `0..n`.
    ///
    /// # Panics
    /// When `n` is zero.
    pub fn index(&mut self, n: usize) -> usize {
        assert!(n > 0, "an index needs something to choose from");
        ((u64::from(self.next_u32()) * n as u64) >> 32) as usize
    }

    /// True with the given probability.
    pub fn chance(&mut self, probability: f32) -> bool {
        self.uniform() < probability
    }

    /// A standard normal number.
    pub fn normal(&mut self) -> f32 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        radius * (core::f32::consts::TAU * self.uniform()).cos()
    }

    /// An angle in [-pi, pi).
    pub fn angle(&mut self) -> f32 {
        self.range(-core::f32::consts::PI, core::f32::consts::PI)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_those_of_the_distributions() {
        let mut rng = Rng::new(7, 1);
        let n = 200_000;
        let uniform: f64 = (0..n).map(|_| f64::from(rng.uniform())).sum::<f64>() / f64::from(n);
        assert!((uniform - 0.5).abs() < 0.005, "{uniform}");
        let normals: Vec<f64> = (0..n).map(|_| f64::from(rng.normal())).collect();
        let mean = normals.iter().sum::<f64>() / f64::from(n);
        let square = normals.iter().map(|x| x * x).sum::<f64>() / f64::from(n);
        assert!(mean.abs() < 0.01 && (square - 1.0).abs() < 0.02, "{mean} {square}");
    }

    #[test]
    fn streams_differ_and_seeds_repeat() {
        assert_ne!(Rng::new(1, 1).next_u32(), Rng::new(1, 2).next_u32());
        assert_eq!(Rng::new(1, 1).next_u32(), Rng::new(1, 1).next_u32());
        let mut rng = Rng::new(3, 3);
        assert!((0..1000).all(|_| rng.index(7) < 7));
    }
}
