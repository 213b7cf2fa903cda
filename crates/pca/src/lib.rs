//! Principal components of rows of numbers, by the power method with deflation. What the paper's figures 5 and 6 are drawn
//! from, by the trainer as files and by the demo as a panel.

/// The leading principal components of a set of rows.
#[derive(Clone, Debug, PartialEq)]
pub struct Components {
    /// Mean of the rows.
    pub mean: Vec<f64>,
    /// Unit directions, largest variance first. Zeros where the rows have no further direction.
    pub directions: Vec<Vec<f64>>,
    /// Variance along each.
    pub variances: Vec<f64>,
    /// Variance in all directions together.
    pub total_variance: f64,
}

/// Most rounds of the power method: enough for components whose variances differ by a few per cent.
const ROUNDS: usize = 200;

/// A direction that a round turns by less has converged: one minus the cosine of the angle.
const CONVERGED: f64 = 1e-14;

impl Components {
    /// The `count` leading components of `rows`, fewer for rows that are shorter. Without rows there is none.
    ///
    /// # Panics
    /// When the rows differ in length.
    #[must_use]
    pub fn of<R: AsRef<[f32]>>(rows: &[R], count: usize) -> Self {
        let width = rows.first().map_or(0, |row| row.as_ref().len());
        assert!(rows.iter().all(|row| row.as_ref().len() == width), "rows of one length");
        let n = rows.len().max(1) as f64;
        let mut mean = vec![0.0; width];
        for row in rows {
            mean.iter_mut().zip(row.as_ref()).for_each(|(m, x)| *m += f64::from(*x) / n);
        }
        let centre = |row: &R| row.as_ref().iter().zip(&mean).map(|(x, m)| f64::from(*x) - m).collect();
        let centred: Vec<Vec<f64>> = rows.iter().map(centre).collect();
        let total_variance = centred.iter().flatten().map(|x| x * x).sum::<f64>() / n;
        let mut components = Self { mean, directions: Vec::new(), variances: Vec::new(), total_variance };
        for index in 0..count.min(width) {
            let direction = components.next_direction(&centred, index);
            let variance = centred.iter().map(|row| dot(row, &direction).powi(2)).sum::<f64>() / n;
            components.directions.push(direction);
            components.variances.push(variance);
        }
        components
    }

    /// Coordinates of a row along the components.
    #[must_use]
    pub fn project(&self, row: &[f32]) -> Vec<f64> {
        let along =
            |d: &Vec<f64>| d.iter().zip(row).zip(&self.mean).map(|((d, x), m)| d * (f64::from(*x) - m)).sum();
        self.directions.iter().map(along).collect()
    }

    /// What the numbers from `start` on add to the coordinates of a row; the mean is not subtracted.
    ///
    /// # Panics
    /// When `part` reaches beyond the end of a row.
    #[must_use]
    pub fn project_part(&self, start: usize, part: &[f32]) -> Vec<f64> {
        let along = |d: &Vec<f64>| {
            d[start..start + part.len()].iter().zip(part).map(|(d, x)| d * f64::from(*x)).sum()
        };
        self.directions.iter().map(along).collect()
    }

    /// The direction of greatest variance at right angles to those that are found.
    fn next_direction(&self, centred: &[Vec<f64>], index: usize) -> Vec<f64> {
        // A start that in practice no direction is at right angles to, the same each time.
        let mut direction: Vec<f64> =
            (0..self.mean.len()).map(|i| ((i * 7 + index) as f64).sin() + 0.1).collect();
        normalise(&mut direction);
        for _ in 0..ROUNDS {
            let mut next = vec![0.0; direction.len()];
            for row in centred {
                let along = dot(row, &direction) / centred.len() as f64;
                next.iter_mut().zip(row).for_each(|(o, x)| *o += along * x);
            }
            self.remove_found(&mut next);
            if !normalise(&mut next) {
                return next;
            }
            let turned = 1.0 - dot(&next, &direction);
            direction = next;
            if turned < CONVERGED {
                break;
            }
        }
        self.remove_found(&mut direction);
        normalise(&mut direction);
        direction
    }

    fn remove_found(&self, vector: &mut [f64]) {
        for found in &self.directions {
            let along = dot(vector, found);
            vector.iter_mut().zip(found).for_each(|(v, f)| *v -= along * f);
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Makes a vector a unit vector. False, and zeros, when its length is nothing or not finite.
fn normalise(vector: &mut [f64]) -> bool {
    let length = dot(vector, vector).sqrt();
    let sound = length > 1e-12 && length.is_finite();
    vector.iter_mut().for_each(|v| *v = if sound { *v / length } else { 0.0 });
    sound
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn components_of_an_ellipse_are_its_axes() {
        let rows: Vec<Vec<f32>> = (0..400)
            .map(|i| {
                let t = std::f32::consts::TAU * i as f32 / 400.0;
                let (a, b) = (3.0 * t.cos(), t.sin());
                vec![5.0 + (a - b) / 2f32.sqrt(), (a + b) / 2f32.sqrt(), 1.0]
            })
            .collect();
        let c = Components::of(&rows, 2);
        assert!(
            (c.variances[0] - 4.5).abs() < 1e-3 && (c.variances[1] - 0.5).abs() < 1e-3,
            "{:?}",
            c.variances
        );
        assert!((c.directions[0][0].abs() - 0.5_f64.sqrt()).abs() < 1e-4);
        assert!((c.total_variance - 5.0).abs() < 1e-3);
        let p = c.project(&rows[0]);
        assert!((p[0].abs() - 3.0).abs() < 1e-3 && p[1].abs() < 1e-3);
    }

    #[test]
    fn every_axis_of_a_stretched_cloud_is_found() {
        // Far along (0.6, 0.8, 0, 0), less along (0, 0, 1, 0), little along (0, 0, 0, 1).
        let rows: Vec<[f32; 4]> = (0..200)
            .map(|i| {
                let (a, b, c) = (
                    (i as f32 * 0.7).sin() * 5.0,
                    (i as f32 * 1.3).cos() * 2.0,
                    (i as f32 * 2.9).sin() * 0.5,
                );
                [0.6 * a + 1.0, 0.8 * a, b, c - 3.0]
            })
            .collect();
        let c = Components::of(&rows, 3);
        let first = &c.directions[0];
        assert!((first[0] * 0.6 + first[1] * 0.8).abs() > 0.999, "{first:?}");
        assert!(c.directions[1][2].abs() > 0.99 && c.directions[2][3].abs() > 0.99);
        // A row is the mean and its parts.
        let parts = [c.project_part(0, &rows[9][..1]), c.project_part(1, &rows[9][1..])];
        let mean: Vec<f32> = c.mean.iter().map(|m| *m as f32).collect();
        let mean = c.project_part(0, &mean);
        for (axis, along) in c.project(&rows[9]).into_iter().enumerate() {
            assert!((parts[0][axis] + parts[1][axis] - mean[axis] - along).abs() < 1e-5);
        }
    }

    #[test]
    fn rows_without_a_further_direction_have_zeros_for_it() {
        let c = Components::of(&[[1.0, 0.0], [-1.0, 0.0]], 3);
        assert!((c.project(&[1.0, 0.0])[0].abs() - 1.0).abs() < 1e-9);
        assert_eq!((c.directions.len(), c.variances[1]), (2, 0.0));
        assert_eq!(c.directions[1], [0.0, 0.0]);
        let none = Components::of::<[f32; 2]>(&[], 3);
        assert!(none.directions.is_empty() && none.project(&[]).is_empty());
        let broken = Components::of(&[[f32::NAN, 1.0], [0.0, 2.0]], 1);
        assert_eq!(broken.directions[0], [0.0, 0.0]);
    }
}
