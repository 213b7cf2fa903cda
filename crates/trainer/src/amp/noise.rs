//! Noise for discriminator inputs.

use random::Rng;

/// A long table of standard normal numbers, read from a random place: noise at the cost of a copy.
#[derive(Clone, Debug)]
pub(super) struct NoiseTable(Vec<f32>);

impl NoiseTable {
    const LEN: usize = 1 << 18;

    /// The table of a seed.
    #[must_use]
    pub(super) fn new(seed: u64) -> Self {
        let mut rng = Rng::new(seed, 0x6e6f_6973);
        Self((0..Self::LEN).map(|_| rng.normal()).collect())
    }

    /// Adds noise of the given deviation to `row`.
    ///
    /// # Panics
    /// When `row` is as long as the table (262,144 numbers).
    pub(super) fn add(&self, rng: &mut Rng, deviation: f32, row: &mut [f32]) {
        let start = rng.index(Self::LEN - row.len());
        for (value, noise) in row.iter_mut().zip(&self.0[start..]) {
            *value += deviation * noise;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_has_the_deviation_asked_for_and_differs_from_call_to_call() {
        let (table, mut rng) = (NoiseTable::new(5), Rng::new(5, 1));
        let mut rows = [vec![2.0; 50_000], vec![2.0; 50_000]];
        rows.iter_mut().for_each(|row| table.add(&mut rng, 0.5, row));
        let mean = rows[0].iter().sum::<f32>() / 50_000.0;
        let square = rows[0].iter().map(|x| (x - mean).powi(2)).sum::<f32>() / 50_000.0;
        assert!((mean - 2.0).abs() < 0.02 && (square.sqrt() - 0.5).abs() < 0.02, "{mean} {square}");
        assert_ne!(rows[0], rows[1]);
    }
}
