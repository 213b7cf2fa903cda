//! The first three principal components of rows of numbers, by power iteration.

use glam::Vec3;

/// Rounds of the power iteration; pictures need no more.
const ROUNDS: usize = 60;

/// Mean and axes.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Components {
    mean: Vec<f32>,
    axes: [Vec<f32>; 3],
    scale: f32,
}

impl Components {
    /// Of rows of one length. No rows: everything projects to the origin.
    pub(super) fn of(rows: &[&[f32]]) -> Self {
        let length = rows.first().map_or(0, |row| row.len());
        let mut mean = vec![0.0; length];
        for row in rows {
            mean.iter_mut().zip(*row).for_each(|(m, v)| *m += v / rows.len() as f32);
        }
        let mut axes: [Vec<f32>; 3] = Default::default();
        for axis in 0..3 {
            let (found, open) = axes.split_at_mut(axis);
            open[0] = strongest(rows, &mean, found);
        }
        let mut components = Self { mean, axes, scale: 1.0 };
        let furthest = rows.iter().map(|row| components.project(row).abs().max_element()).fold(0.0, f32::max);
        components.scale = if furthest > 0.0 { 1.0 / furthest } else { 1.0 };
        components
    }

    /// A row on the three axes; the rows it was made of lie within [-1, 1].
    pub(super) fn project(&self, row: &[f32]) -> Vec3 {
        let along = |axis: &[f32]| -> f32 {
            axis.iter().zip(row.iter().zip(&self.mean)).map(|(a, (v, m))| a * (v - m)).sum()
        };
        Vec3::new(along(&self.axes[0]), along(&self.axes[1]), along(&self.axes[2])) * self.scale
    }

    /// A direction of rows on the three axes, without the mean.
    pub(super) fn project_direction(&self, row: &[f32], start: usize) -> Vec3 {
        let along = |axis: &[f32]| -> f32 {
            axis[start..start + row.len()].iter().zip(row).map(|(a, v)| a * v).sum()
        };
        Vec3::new(along(&self.axes[0]), along(&self.axes[1]), along(&self.axes[2])) * self.scale
    }

    /// Where the mean is.
    pub(super) fn mean_on_axes(&self) -> Vec3 {
        self.project_direction(&self.mean, 0)
    }
}

/// Direction of greatest variance at right angles to `found`.
fn strongest(rows: &[&[f32]], mean: &[f32], found: &[Vec<f32>]) -> Vec<f32> {
    // A start that no axis is at right angles to in practice, the same each time.
    let mut axis: Vec<f32> = (0..mean.len()).map(|i| 1.0 + (i * 7 % 11) as f32 * 0.1).collect();
    normalise(&mut axis, found);
    for _ in 0..ROUNDS {
        let mut next = vec![0.0; mean.len()];
        for row in rows {
            let along: f32 = axis.iter().zip(row.iter().zip(mean)).map(|(a, (v, m))| a * (v - m)).sum();
            next.iter_mut().zip(row.iter().zip(mean)).for_each(|(n, (v, m))| *n += along * (v - m));
        }
        axis = next;
        if !normalise(&mut axis, found) {
            break;
        }
    }
    axis
}

/// Takes out what lies along `found` and makes the rest a unit vector; false (and zero) when nothing is left.
fn normalise(axis: &mut [f32], found: &[Vec<f32>]) -> bool {
    for other in found {
        let along: f32 = axis.iter().zip(other).map(|(a, b)| a * b).sum();
        axis.iter_mut().zip(other).for_each(|(a, b)| *a -= along * b);
    }
    let length = axis.iter().map(|a| a * a).sum::<f32>().sqrt();
    let sound = length > 1e-12 && length.is_finite();
    axis.iter_mut().for_each(|a| *a = if sound { *a / length } else { 0.0 });
    sound
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stretched_cloud_lies_along_its_axes() {
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
        let flat: Vec<&[f32]> = rows.iter().map(|r| &r[..]).collect();
        let components = Components::of(&flat);
        let first = &components.axes[0];
        assert!((first[0] * 0.6 + first[1] * 0.8).abs() > 0.999, "{first:?}");
        assert!(components.axes[1][2].abs() > 0.99 && components.axes[2][3].abs() > 0.99);
        let furthest = rows.iter().map(|r| components.project(r).abs().max_element()).fold(0.0, f32::max);
        assert!((furthest - 1.0).abs() < 1e-5);
    }

    #[test]
    fn too_little_to_have_three_axes_is_no_harm() {
        let rows: [&[f32]; 2] = [&[1.0, 0.0], &[-1.0, 0.0]];
        let components = Components::of(&rows);
        assert!((components.project(&[1.0, 0.0]).x.abs() - 1.0).abs() < 1e-5);
        assert_eq!(Components::of(&[]).project(&[]), Vec3::ZERO);
    }
}
