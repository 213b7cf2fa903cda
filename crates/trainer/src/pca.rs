//! Principal components of rows: what figures 5 and 6 of the paper are drawn from.

/// The leading principal components of a set of rows.
#[derive(Clone, Debug, PartialEq)]
pub struct Components {
    /// Mean of the rows.
    pub mean: Vec<f64>,
    /// Unit directions, largest variance first.
    pub directions: Vec<Vec<f64>>,
    /// Variance along each.
    pub variances: Vec<f64>,
    /// Variance in all directions together.
    pub total_variance: f64,
}

/// Rounds of the power method: enough for components whose variances differ by a few per cent.
const ROUNDS: usize = 200;

impl Components {
    /// The `count` leading components of `rows`, by the power method with deflation.
    ///
    /// # Panics
    /// When there is no row or the rows differ in length.
    #[must_use]
    pub fn of(rows: &[Vec<f32>], count: usize) -> Self {
        let width = rows.first().expect("components need rows").len();
        assert!(rows.iter().all(|r| r.len() == width), "rows of one length");
        let n = rows.len() as f64;
        let mut mean = vec![0.0; width];
        for row in rows {
            mean.iter_mut().zip(row).for_each(|(m, x)| *m += f64::from(*x) / n);
        }
        let centred: Vec<Vec<f64>> =
            rows.iter().map(|r| r.iter().zip(&mean).map(|(x, m)| f64::from(*x) - m).collect()).collect();
        let total_variance = centred.iter().flatten().map(|x| x * x).sum::<f64>() / n;
        let mut components = Self { mean, directions: Vec::new(), variances: Vec::new(), total_variance };
        for index in 0..count.min(width) {
            let mut direction: Vec<f64> = (0..width).map(|i| ((i * 7 + index) as f64).sin() + 0.1).collect();
            for _ in 0..ROUNDS {
                let mut next = vec![0.0; width];
                for row in &centred {
                    let along = dot(row, &direction);
                    next.iter_mut().zip(row).for_each(|(o, x)| *o += along * x / n);
                }
                components.remove_found(&mut next);
                if !normalise(&mut next) {
                    break;
                }
                direction = next;
            }
            components.remove_found(&mut direction);
            normalise(&mut direction);
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

fn normalise(vector: &mut [f64]) -> bool {
    let length = dot(vector, vector).sqrt();
    if length < 1e-12 {
        return false;
    }
    vector.iter_mut().for_each(|v| *v /= length);
    true
}

/// Pearson's correlation of two lists of equal length; zero when one of them is constant.
#[must_use]
pub fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let n = a.len().min(b.len()).max(1) as f64;
    let (ma, mb) = (a.iter().sum::<f64>() / n, b.iter().sum::<f64>() / n);
    let covariance: f64 = a.iter().zip(b).map(|(x, y)| (x - ma) * (y - mb)).sum();
    let spread = |v: &[f64], m: f64| v.iter().map(|x| (x - m).powi(2)).sum::<f64>().sqrt();
    let scale = spread(a, ma) * spread(b, mb);
    if scale < 1e-12 { 0.0 } else { covariance / scale }
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
    fn correlation_of_lines_is_one() {
        assert!((correlation(&[1.0, 2.0, 3.0], &[2.0, 4.0, 6.0]) - 1.0).abs() < 1e-12);
        assert!((correlation(&[1.0, 2.0, 3.0], &[3.0, 2.0, 1.0]) + 1.0).abs() < 1e-12);
        assert_eq!(correlation(&[1.0, 1.0], &[0.0, 5.0]), 0.0);
    }
}
