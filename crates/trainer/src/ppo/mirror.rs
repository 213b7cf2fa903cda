//! The mirror image of what a policy sees and does, for the symmetry loss.

/// A reordering of numbers, some of them negated, that is its own inverse.
///
/// ```
/// use trainer::ppo::SignedPermutation;
/// let swap = SignedPermutation::new(vec![(1, 1.0), (0, 1.0), (2, -1.0)]);
/// let mut out = [0.0; 3];
/// swap.apply_into(&[5.0, 6.0, 7.0], &mut out);
/// assert_eq!(out, [6.0, 5.0, -7.0]);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SignedPermutation {
    entries: Vec<(usize, f32)>,
}

impl SignedPermutation {
    /// Number `i` of a result is the number at `entries[i].0`, times the sign `entries[i].1`.
    ///
    /// # Panics
    /// When applying it twice does not give the numbers back.
    #[must_use]
    pub fn new(entries: Vec<(usize, f32)>) -> Self {
        for (index, &(from, sign)) in entries.iter().enumerate() {
            assert!(sign.abs() == 1.0, "expected a sign of 1 or -1 at {index}, found {sign}");
            let back = entries.get(from);
            assert!(
                back == Some(&(index, sign)),
                "expected entry {from} to lead back to {index} by the same sign, found {back:?}"
            );
        }
        Self { entries }
    }

    /// How many numbers it reorders.
    #[must_use]
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// Whether it reorders nothing.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Where number `index` of a result comes from, and its sign.
    ///
    /// # Panics
    /// When there is no such number.
    #[must_use]
    pub fn entry(&self, index: usize) -> (usize, f32) {
        self.entries[index]
    }

    /// Writes the mirror image of `values` to `out`.
    ///
    /// # Panics
    /// When `values` is shorter than the permutation.
    pub fn apply_into(&self, values: &[f32], out: &mut [f32]) {
        for (out, (from, sign)) in out.iter_mut().zip(&self.entries) {
            *out = sign * values[*from];
        }
    }

    /// Writes the mirror image of every row of `rows` to the same row of `out`; rows are as long as the permutation.
    ///
    /// # Panics
    /// When the permutation is empty.
    pub fn apply_rows_into(&self, rows: &[f32], out: &mut [f32]) {
        let pairs = rows.chunks_exact(self.len()).zip(out.chunks_exact_mut(self.len()));
        pairs.for_each(|(row, out)| self.apply_into(row, out));
    }

    /// Makes of `values` the mean of themselves and of the mirror image of `others`.
    ///
    /// # Panics
    /// When `others` is shorter than the permutation.
    pub fn average_into(&self, others: &[f32], values: &mut [f32]) {
        for (value, (from, sign)) in values.iter_mut().zip(&self.entries) {
            *value = 0.5 * (*value + sign * others[*from]);
        }
    }
}

/// The mirror image of policy inputs and of actions.
#[derive(Clone, Debug, PartialEq)]
pub struct Mirror {
    /// Of policy inputs, normalised, the target included.
    pub inputs: SignedPermutation,
    /// Of actions.
    pub actions: SignedPermutation,
}

impl Mirror {
    /// The squared distance between an action and the mirror image of `other`, the action in the mirrored state. Adds
    /// `factor` times its gradient to the deltas of both.
    pub(super) fn asymmetry(
        &self,
        [action, other]: [&[f32]; 2],
        [delta, other_delta]: [&mut [f32]; 2],
        factor: f32,
    ) -> f32 {
        let mut squares = 0.0;
        for (joint, (action, delta)) in action.iter().zip(delta).enumerate() {
            let (from, sign) = self.actions.entry(joint);
            let difference = action - sign * other[from];
            squares += difference * difference;
            *delta += 2.0 * factor * difference;
            other_delta[from] -= 2.0 * factor * sign * difference;
        }
        squares
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[should_panic(expected = "expected entry 1 to lead back to 0")]
    fn a_reordering_that_does_not_lead_back_is_refused() {
        let _ = SignedPermutation::new(vec![(1, 1.0), (2, 1.0), (0, 1.0)]);
    }

    #[test]
    fn the_gradient_is_that_of_the_squared_distance() {
        let actions = SignedPermutation::new(vec![(1, -1.0), (0, -1.0), (2, 1.0)]);
        let mirror = Mirror { inputs: actions.clone(), actions };
        let numbers = [[0.3, -0.2, 0.7], [0.1, 0.4, -0.6]];
        let value = |numbers: [[f32; 3]; 2]| {
            let mut deltas = [[0.0; 3]; 2];
            let [first, second] = &mut deltas;
            let square = mirror.asymmetry([&numbers[0], &numbers[1]], [first, second], 1.0);
            (square, deltas)
        };
        let (square, deltas) = value(numbers);
        for side in 0..2 {
            for joint in 0..3 {
                let mut moved = numbers;
                moved[side][joint] += 1e-3;
                let slope = (value(moved).0 - square) / 1e-3;
                let expected = deltas[side][joint];
                assert!((slope - expected).abs() < 5e-3, "{side} {joint}: {slope}, {expected}");
            }
        }
    }
}
