//! How high the ground is, as the compiled model has it: what is walked on, not what was asked for.

use glam::Vec3;
use mujoco_rs::wrappers::mj_model::{MjModel, MjtGeomBase, MjtObjBase};

use crate::mjcf::{FLOOR, HEIGHT_FIELD};
use crate::model_error::ModelError;

/// Ground of a model: an endless plane and, on some terrains, a height field above it.
#[derive(Debug)]
pub(crate) struct Ground {
    plane_height: f32,
    pub field: Option<HeightField>,
}

/// A rectangular grid of heights about the origin, each cell two triangles that share the edge from its
/// lowest row and column to its highest.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightField {
    rows: usize,
    columns: usize,
    half_extent: [f32; 2],
    heights: Box<[f32]>,
}

impl HeightField {
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

    /// Height at a point, `None` outside the field.
    fn height_at(&self, x: f32, y: f32) -> Option<f32> {
        let [half_x, half_y] = self.half_extent;
        if !(x.abs() <= half_x && y.abs() <= half_y) {
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

impl Ground {
    pub(crate) fn of(model: &MjModel) -> Result<Self, ModelError> {
        let floor = model
            .name_to_id(MjtObjBase::mjOBJ_GEOM, FLOOR)
            .ok_or(ModelError::Missing { kind: "geom", name: FLOOR })?;
        let is_level = model.geom_type()[floor] == MjtGeomBase::mjGEOM_PLANE
            && model.geom_bodyid()[floor] == 0
            && model.geom_quat()[floor] == [1.0, 0.0, 0.0, 0.0];
        if !is_level {
            return Err(ModelError::Kind { kind: "geom", name: FLOOR, expected: "a level plane" });
        }
        let field =
            model.name_to_id(MjtObjBase::mjOBJ_GEOM, HEIGHT_FIELD).map(|geom| height_field(model, geom));
        Ok(Self { plane_height: model.geom_pos()[floor][2] as f32, field })
    }

    pub(crate) fn height_at(&self, x: f32, y: f32) -> f32 {
        let above = self.field.as_ref().and_then(|field| field.height_at(x, y));
        above.map_or(self.plane_height, |height| height.max(self.plane_height))
    }
}

/// Reads back the height field of a geom that this crate made.
fn height_field(model: &MjModel, geom: usize) -> HeightField {
    let field = model.geom_dataid()[geom] as usize;
    let (rows, columns) = (model.hfield_nrow()[field] as usize, model.hfield_ncol()[field] as usize);
    let [half_x, half_y, scale, _] = model.hfield_size()[field];
    let first = model.hfield_adr()[field] as usize;
    let base = model.geom_pos()[geom][2];
    let heights = &model.hfield_data()[first..first + rows * columns];
    HeightField {
        rows,
        columns,
        half_extent: [half_x as f32, half_y as f32],
        heights: heights.iter().map(|&h| (base + f64::from(h) * scale) as f32).collect(),
    }
}
