//! Simulated rows of earlier iterations, so that a discriminator does not forget what it once told apart.

use random::Rng;

/// A ring of discriminator inputs. Grows as it fills.
#[derive(Clone, Debug)]
pub struct Replay {
    rows: Vec<f32>,
    width: usize,
    capacity: usize,
    next: usize,
}

impl Replay {
    /// An empty ring of at most `capacity` rows of `width` numbers.
    ///
    /// # Panics
    /// When `capacity` or `width` is zero.
    #[must_use]
    pub fn new(capacity: usize, width: usize) -> Self {
        assert!(capacity > 0 && width > 0, "a replay holds rows");
        Self { rows: Vec::new(), width, capacity, next: 0 }
    }

    /// Rows held.
    #[must_use]
    pub fn len(&self) -> usize {
        self.rows.len() / self.width
    }

    /// True before the first row.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Stores a row in place of the oldest.
    ///
    /// # Panics
    /// When the row is of another width.
    pub fn push(&mut self, row: &[f32]) {
        assert_eq!(row.len(), self.width, "width of a row");
        if self.len() < self.capacity {
            self.rows.extend_from_slice(row);
        } else {
            let at = self.next * self.width;
            self.rows[at..at + self.width].copy_from_slice(row);
        }
        self.next = (self.next + 1) % self.capacity;
    }

    /// A random row.
    ///
    /// # Panics
    /// When it is empty.
    #[must_use]
    pub fn draw(&self, rng: &mut Rng) -> &[f32] {
        let at = rng.index(self.len()) * self.width;
        &self.rows[at..at + self.width]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_oldest_row_gives_way() {
        let mut replay = Replay::new(3, 7);
        assert!(replay.is_empty());
        for i in 0..5 {
            replay.push(&[i as f32; 7]);
        }
        assert_eq!(replay.len(), 3);
        let mut rng = Rng::new(1, 1);
        assert!((0..100).all(|_| replay.draw(&mut rng)[0] >= 2.0));
    }
}
