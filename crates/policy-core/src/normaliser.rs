//! One mean and one deviation for the whole graph: policies that saw differently normalised inputs could
//! not be blended.

use alloc::vec::Vec;

/// Normalised values are clipped to plus and minus this.
pub const NORMALISED_LIMIT: f32 = 5.0;

/// The least deviation a normaliser divides by.
pub const LEAST_DEVIATION: f32 = 0.1;

/// Affine normalisation `clip((x - mean) / deviation, -5, 5)` of a fixed number of values.
#[derive(Clone, Debug, PartialEq)]
pub struct Normaliser {
    mean: Vec<f32>,
    deviation: Vec<f32>,
}

/// Why a [`Normaliser`] can't be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NormaliserError {
    /// Mean and deviation differ in length.
    #[error("expected as many deviations as means ({means}), found {deviations}")]
    Lengths {
        /// Number of means.
        means: usize,
        /// Number of deviations.
        deviations: usize,
    },
    /// A mean is not finite.
    #[error("expected a finite mean at index {index}, found {found}")]
    Mean {
        /// Index of the value.
        index: usize,
        /// Its mean.
        found: f32,
    },
    /// A deviation is not a finite number of at least [`LEAST_DEVIATION`].
    #[error("expected a finite deviation of at least {LEAST_DEVIATION} at index {index}, found {found}")]
    Deviation {
        /// Index of the value.
        index: usize,
        /// Its deviation.
        found: f32,
    },
}

impl Normaliser {
    /// A normaliser for as many values as there are means.
    ///
    /// # Errors
    /// When the lengths differ, a number is not finite, or a deviation lies under [`LEAST_DEVIATION`].
    pub fn from_mean_and_deviation(mean: &[f32], deviation: &[f32]) -> Result<Self, NormaliserError> {
        if mean.len() != deviation.len() {
            return Err(NormaliserError::Lengths { means: mean.len(), deviations: deviation.len() });
        }
        if let Some(index) = mean.iter().position(|m| !m.is_finite()) {
            // `position` found the index.
            return Err(NormaliserError::Mean { index, found: mean[index] });
        }
        // A hair of slack, for a deviation that was clamped in double precision and rounded afterwards.
        let too_small = |d: &f32| !d.is_finite() || *d < LEAST_DEVIATION * (1.0 - 1e-6);
        if let Some(index) = deviation.iter().position(too_small) {
            // `position` found the index, and the lists are equally long.
            return Err(NormaliserError::Deviation { index, found: deviation[index] });
        }
        Ok(Self { mean: mean.into(), deviation: deviation.into() })
    }

    /// Number of values it normalises.
    #[must_use]
    pub fn len(&self) -> usize {
        self.mean.len()
    }

    /// True for a normaliser of no values.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.mean.is_empty()
    }

    /// Mean of every value.
    #[must_use]
    pub fn mean(&self) -> &[f32] {
        &self.mean
    }

    /// Deviation of every value.
    #[must_use]
    pub fn deviation(&self) -> &[f32] {
        &self.deviation
    }

    /// Normalises `values` in place. The result lies in [-5, 5]; NaN stays NaN.
    ///
    /// # Panics
    /// When `values` has another length than the normaliser.
    pub fn normalise_in_place(&self, values: &mut [f32]) {
        assert_eq!(values.len(), self.mean.len(), "values to normalise");
        for ((v, m), d) in values.iter_mut().zip(&self.mean).zip(&self.deviation) {
            *v = ((*v - m) / d).clamp(-NORMALISED_LIMIT, NORMALISED_LIMIT);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normalises_and_clips() {
        let n = Normaliser::from_mean_and_deviation(&[1.0, 0.0, 0.0], &[0.5, 0.1, 1.0]).unwrap();
        let mut v = [2.0, 9.0, f32::NEG_INFINITY];
        n.normalise_in_place(&mut v);
        assert_eq!(v, [2.0, 5.0, -5.0]);
    }

    #[test]
    fn bad_numbers_are_named() {
        let e = Normaliser::from_mean_and_deviation(&[0.0, f32::NAN], &[1.0, 1.0]).unwrap_err();
        assert!(matches!(e, NormaliserError::Mean { index: 1, .. }));
        let e = Normaliser::from_mean_and_deviation(&[0.0], &[0.01]).unwrap_err();
        assert!(matches!(e, NormaliserError::Deviation { index: 0, .. }));
        let e = Normaliser::from_mean_and_deviation(&[0.0], &[]).unwrap_err();
        assert_eq!(e, NormaliserError::Lengths { means: 1, deviations: 0 });
    }
}
