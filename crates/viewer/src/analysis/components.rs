//! The first three principal components of rows of numbers, as points that fit a panel.

use glam::Vec3;

/// Axes of a panel.
const AXES: usize = 3;

/// Three components, scaled so that the rows they were made of lie within [-1, 1].
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Components {
    found: pca::Components,
    scale: f32,
}

impl Components {
    /// Of rows of one length. Without rows everything projects to the origin.
    pub(super) fn of(rows: &[&[f32]]) -> Self {
        let mut components = Self { found: pca::Components::of(rows, AXES), scale: 1.0 };
        let furthest = rows.iter().map(|row| components.project(row).abs().max_element()).fold(0.0, f32::max);
        components.scale = if furthest > 0.0 { 1.0 / furthest } else { 1.0 };
        components
    }

    /// A row on the three axes.
    pub(super) fn project(&self, row: &[f32]) -> Vec3 {
        self.scaled(&self.found.project(row))
    }

    /// What the numbers of a row from `start` on add to its place, without the mean.
    pub(super) fn project_part(&self, start: usize, part: &[f32]) -> Vec3 {
        self.scaled(&self.found.project_part(start, part))
    }

    /// Where the mean is.
    pub(super) fn mean_on_axes(&self) -> Vec3 {
        let mean: Vec<f32> = self.found.mean.iter().map(|m| *m as f32).collect();
        self.project_part(0, &mean)
    }

    /// Rows that are too short have fewer than three components; the rest is zero.
    fn scaled(&self, along: &[f64]) -> Vec3 {
        let axis = |index: usize| along.get(index).map_or(0.0, |x| *x as f32);
        Vec3::new(axis(0), axis(1), axis(2)) * self.scale
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_furthest_row_touches_the_edge() {
        let rows: Vec<[f32; 4]> = (0..200)
            .map(|i| [5.0 * (i as f32 * 0.7).sin(), 1.0, (i as f32 * 1.3).cos(), (i as f32 * 2.9).sin()])
            .collect();
        let flat: Vec<&[f32]> = rows.iter().map(|r| &r[..]).collect();
        let components = Components::of(&flat);
        let furthest = rows.iter().map(|r| components.project(r).abs().max_element()).fold(0.0, f32::max);
        assert!((furthest - 1.0).abs() < 1e-5);
        // A row is its parts, less the mean.
        let parts = components.project_part(0, &rows[7][..3]) + components.project_part(3, &rows[7][3..]);
        let apart = (parts - components.mean_on_axes()).distance(components.project(&rows[7]));
        assert!(apart < 1e-5, "{apart}");
    }

    #[test]
    fn too_little_to_have_three_axes_is_no_harm() {
        let rows: [&[f32]; 2] = [&[1.0, 0.0], &[-1.0, 0.0]];
        let components = Components::of(&rows);
        assert!((components.project(&[1.0, 0.0]).x.abs() - 1.0).abs() < 1e-5);
        assert_eq!(components.project(&[1.0, 0.0]).z, 0.0);
        assert_eq!(Components::of(&[]).project(&[]), Vec3::ZERO);
    }
}
