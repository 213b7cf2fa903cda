//! Uneven ground as a grid of heights, the same for every physics.

use alloc::boxed::Box;

use glam::Vec3;

/// A rectangular grid of heights about the origin, each cell two triangles that share the edge from its
/// lowest row and column to its highest.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightField {
    rows: usize,
    columns: usize,
    half_extent: [f32; 2],
    heights: Box<[f32]>,
}

/// The numbers make no grid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "expected at least 2 x 2 finite heights on a positive extent, found {found} heights for {rows} x {columns} points"
)]
#[non_exhaustive]
pub struct HeightFieldError {
    /// Points along y.
    pub rows: usize,
    /// Points along x.
    pub columns: usize,
    /// Heights found.
    pub found: usize,
}

impl HeightField {
    /// A grid of `rows` points along y and `columns` along x, up to `half_extent` metres from the origin along x and y.
    /// Heights come row by row, metres, world space.
    ///
    /// # Errors
    /// When there are fewer than two rows or columns, the heights are not as many or not finite, or the extent is not positive.
    pub fn from_heights(
        [rows, columns]: [usize; 2],
        half_extent: [f32; 2],
        heights: impl Into<Box<[f32]>>,
    ) -> Result<Self, HeightFieldError> {
        let heights = heights.into();
        let sized = rows >= 2 && columns >= 2 && rows.checked_mul(columns) == Some(heights.len());
        let finite = heights.iter().all(|height| height.is_finite());
        let extended = half_extent.iter().all(|half| half.is_finite() && *half > 0.0);
        if sized && finite && extended {
            Ok(Self { rows, columns, half_extent, heights })
        } else {
            Err(HeightFieldError { rows, columns, found: heights.len() })
        }
    }

    /// Points along y.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Points along x.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Half the sides along x and y, metres.
    #[must_use]
    pub fn half_extent(&self) -> [f32; 2] {
        self.half_extent
    }

    /// Heights row by row, metres, world space; x grows along a row, y from row to row.
    #[must_use]
    pub fn heights(&self) -> &[f32] {
        &self.heights
    }

    /// A point of the grid, world space.
    ///
    /// # Panics
    /// When there is no such row or column.
    #[must_use]
    pub fn point(&self, row: usize, column: usize) -> Vec3 {
        let along = |i: usize, n: usize, half: f32| half * (2.0 * i as f32 / (n - 1) as f32 - 1.0);
        Vec3::new(
            along(column, self.columns, self.half_extent[0]),
            along(row, self.rows, self.half_extent[1]),
            self.heights[row * self.columns + column],
        )
    }

    /// Height at a point, metres; `None` outside the field.
    #[must_use]
    pub fn height_at(&self, x: f32, y: f32) -> Option<f32> {
        let [half_x, half_y] = self.half_extent;
        // Also for what is no number.
        let within = (-half_x..=half_x).contains(&x) && (-half_y..=half_y).contains(&y);
        if !within {
            return None;
        }
        let (column, u) = cell((x + half_x) / (2.0 * half_x), self.columns);
        let (row, v) = cell((y + half_y) / (2.0 * half_y), self.rows);
        let at = |row: usize, column: usize| self.heights[row * self.columns + column];
        let (here, across) = (at(row, column), at(row + 1, column + 1));
        Some(if u >= v {
            let beside = at(row, column + 1);
            here + u * (beside - here) + v * (across - beside)
        } else {
            let above = at(row + 1, column);
            here + v * (above - here) + u * (across - above)
        })
    }
}

/// Which of `points - 1` cells a fraction of the side falls into, and how far.
fn cell(fraction: f32, points: usize) -> (usize, f32) {
    let place = fraction * (points - 1) as f32;
    let index = (place as usize).min(points - 2);
    (index, place - index as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_is_two_triangles_with_the_diagonal_from_its_lowest_corner() {
        let field = HeightField::from_heights([2, 2], [1.0, 2.0], [0.0, 1.0, 3.0, 2.0]).unwrap();
        for (x, y, height) in [(-1.0, -2.0, 0.0), (1.0, -2.0, 1.0), (-1.0, 2.0, 3.0), (0.0, 0.0, 1.0)] {
            assert_eq!(field.height_at(x, y), Some(height), "{x} {y}");
        }
        assert_eq!((field.height_at(1.1, 0.0), field.height_at(0.0, f32::NAN)), (None, None));
        assert_eq!(field.point(1, 0), Vec3::new(-1.0, 2.0, 3.0));
    }

    #[test]
    fn numbers_that_make_no_grid_are_refused() {
        let grid = |size, half, heights: &[f32]| HeightField::from_heights(size, half, heights);
        assert!(grid([1, 2], [1.0; 2], &[0.0; 2]).is_err() && grid([2, 2], [1.0; 2], &[0.0; 3]).is_err());
        assert!(grid([2, 2], [0.0, 1.0], &[0.0; 4]).is_err());
        assert!(grid([2, 2], [1.0; 2], &[0.0, f32::NAN, 0.0, 0.0]).is_err());
        assert!(grid([usize::MAX, 2], [1.0; 2], &[0.0; 4]).is_err());
    }
}
