//! Simulated rows of earlier iterations, so that a discriminator does not forget what it once told apart.

use policy_core::DISCRIMINATOR_INPUT_LEN;

use crate::Rng;

/// A ring of discriminator inputs. Grows as it fills.
#[derive(Clone, Debug)]
pub struct Replay {
    rows: Vec<f32>,
    capacity: usize,
    next: usize,
}

impl Replay {
    /// An empty ring of at most `capacity` rows.
    ///
    /// # Panics
    /// When `capacity` is zero.
    #[must_use]
    pub fn new(capacity: usize) -> Self {
        assert!(capacity > 0, "a replay holds rows");
        Self { rows: Vec::new(), capacity, next: 0 }
    }

    /// Rows held.
    #[must_use]
    pub fn len(&self) -> usize {
        self.rows.len() / DISCRIMINATOR_INPUT_LEN
    }

    /// True before the first row.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Stores a row in place of the oldest.
    pub fn push(&mut self, row: &[f32; DISCRIMINATOR_INPUT_LEN]) {
        if self.len() < self.capacity {
            self.rows.extend_from_slice(row);
        } else {
            let at = self.next * DISCRIMINATOR_INPUT_LEN;
            self.rows[at..at + DISCRIMINATOR_INPUT_LEN].copy_from_slice(row);
        }
        self.next = (self.next + 1) % self.capacity;
    }

    /// A random row.
    ///
    /// # Panics
    /// When it is empty.
    #[must_use]
    pub fn draw(&self, rng: &mut Rng) -> &[f32] {
        let at = rng.index(self.len()) * DISCRIMINATOR_INPUT_LEN;
        &self.rows[at..at + DISCRIMINATOR_INPUT_LEN]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_oldest_row_gives_way() {
        let mut replay = Replay::new(3);
        assert!(replay.is_empty());
        for i in 0..5 {
            replay.push(&[i as f32; DISCRIMINATOR_INPUT_LEN]);
        }
        assert_eq!(replay.len(), 3);
        let mut rng = Rng::new(1, 1);
        assert!((0..100).all(|_| replay.draw(&mut rng)[0] >= 2.0));
    }
}
