//! Unit solids for markers and collision shapes, and the ground, as triangles.

use std::f32::consts::TAU;
use std::ops::Range;

use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3};

use super::scene::{SOLIDS, Solid};

/// Corner of a solid or of the ground.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct SolidVertex {
    /// Metres.
    pub position: [f32; 3],
    /// Unit length.
    pub normal: [f32; 3],
}

impl SolidVertex {
    fn new(position: Vec3, normal: Vec3) -> Self {
        Self { position: position.to_array(), normal: normal.to_array() }
    }
}

/// All solids in one list of triangles, and the range of each in the order of [`Solid::ALL`].
pub(super) fn solids() -> (Vec<SolidVertex>, [Range<u32>; SOLIDS]) {
    let mut all = Vec::new();
    let ranges = Solid::ALL.map(|solid| {
        let start = all.len() as u32;
        match solid {
            Solid::Ball => ball(&mut all),
            Solid::Tube => turned(&mut all, |t| (Vec2::new(1.0, 2.0 * t - 1.0), Vec2::X)),
            Solid::Cube => cube(&mut all),
            Solid::Cone => {
                let slant = Vec2::splat(std::f32::consts::FRAC_1_SQRT_2);
                turned(&mut all, |t| (Vec2::new(1.0 - t, t), slant));
            }
            Solid::Ring => turned(&mut all, |t| (Vec2::new(0.9 + 0.1 * t, 0.0), Vec2::Y)),
            Solid::Drum => {
                turned(&mut all, |t| (Vec2::new(1.0, 2.0 * t - 1.0), Vec2::X));
                turned(&mut all, |t| (Vec2::new(1.0 - t, 1.0), Vec2::Y));
                turned(&mut all, |t| (Vec2::new(t, -1.0), Vec2::NEG_Y));
            }
        }
        start..all.len() as u32
    });
    (all, ranges)
}

const SIDES: usize = 24;

/// A band about z; `profile` gives radius and height, and the normal in the same plane, at 0 and 1.
fn turned(out: &mut Vec<SolidVertex>, profile: impl Fn(f32) -> (Vec2, Vec2)) {
    let vertex = |side: usize, t: f32| {
        let around = Vec2::from_angle(side as f32 / SIDES as f32 * TAU);
        let (p, n) = profile(t);
        SolidVertex::new((around * p.x).extend(p.y), (around * n.x).extend(n.y))
    };
    for side in 0..SIDES {
        let corners = [vertex(side, 0.0), vertex(side + 1, 0.0), vertex(side + 1, 1.0), vertex(side, 1.0)];
        out.extend([0, 1, 2, 0, 2, 3].map(|i| corners[i]));
    }
}

fn ball(out: &mut Vec<SolidVertex>) {
    const RINGS: usize = 12;
    for ring in 0..RINGS {
        turned(out, |t| {
            let angle = ((ring as f32 + t) / RINGS as f32 - 0.5) * 0.5 * TAU;
            let p = Vec2::new(angle.cos(), angle.sin());
            (p, p)
        });
    }
}

fn cube(out: &mut Vec<SolidVertex>) {
    for axis in 0..3 {
        let (u, v) = (Vec3::AXES[(axis + 1) % 3], Vec3::AXES[(axis + 2) % 3]);
        for side in [-1.0, 1.0] {
            let n = Vec3::AXES[axis] * side;
            let corners = [n - u - v, n + u - v, n + u + v, n - u + v].map(|p| SolidVertex::new(p, n));
            out.extend([0, 1, 2, 0, 2, 3].map(|i| corners[i]));
        }
    }
}

/// Heights of the ground on a grid, centred on the origin; flat beyond it.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundGrid {
    /// Points along y and x.
    pub rows: usize,
    /// Points along x.
    pub columns: usize,
    /// Half the sides along x and y, metres.
    pub half_extent: [f32; 2],
    /// Heights, row by row, metres.
    pub heights: Vec<f32>,
    /// Height outside the grid.
    pub outside: f32,
}

/// How far the flat ground goes, metres.
const HORIZON: f32 = 400.0;

/// Triangles of the ground: a large square, and the grid on top of it.
pub(super) fn ground(grid: Option<&GroundGrid>) -> Vec<SolidVertex> {
    let mut out = Vec::new();
    let outside = grid.map_or(0.0, |g| g.outside);
    let hole = grid.map_or(Vec2::ZERO, |g| Vec2::from(g.half_extent));
    // Four strips around the grid, so that nothing lies under it.
    let far = HORIZON;
    let strips = [
        (Vec2::new(-far, -far), Vec2::new(far, -hole.y)),
        (Vec2::new(-far, hole.y), Vec2::new(far, far)),
        (Vec2::new(-far, -hole.y), Vec2::new(-hole.x, hole.y)),
        (Vec2::new(hole.x, -hole.y), Vec2::new(far, hole.y)),
    ];
    for (low, high) in strips {
        let corners = [low, Vec2::new(high.x, low.y), high, Vec2::new(low.x, high.y)];
        out.extend([0, 1, 2, 0, 2, 3].map(|i: usize| SolidVertex::new(corners[i].extend(outside), Vec3::Z)));
    }
    if let Some(grid) = grid {
        push_grid(grid, &mut out);
    }
    out
}

fn push_grid(grid: &GroundGrid, out: &mut Vec<SolidVertex>) {
    let (rows, columns) = (grid.rows, grid.columns);
    let [half_x, half_y] = grid.half_extent;
    let step = Vec2::new(2.0 * half_x / (columns - 1) as f32, 2.0 * half_y / (rows - 1) as f32);
    let height =
        |row: usize, column: usize| grid.heights[row.min(rows - 1) * columns + column.min(columns - 1)];
    let vertex = |row: usize, column: usize| {
        let across = height(row, column + 1) - height(row, column.saturating_sub(1));
        let up = height(row + 1, column) - height(row.saturating_sub(1), column);
        let normal = Vec3::new(-across / (2.0 * step.x), -up / (2.0 * step.y), 1.0).normalize();
        let at = Vec2::new(column as f32 * step.x - half_x, row as f32 * step.y - half_y);
        SolidVertex::new(at.extend(height(row, column)), normal)
    };
    for row in 0..rows - 1 {
        for column in 0..columns - 1 {
            let (here, beside) = (vertex(row, column), vertex(row, column + 1));
            let (above, across) = (vertex(row + 1, column), vertex(row + 1, column + 1));
            out.extend([here, beside, across, here, across, above]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_of_solids_point_outwards() {
        let (vertices, ranges) = solids();
        for range in ranges[..3].iter().chain(&ranges[5..]) {
            for v in &vertices[range.start as usize..range.end as usize] {
                let (p, n) = (Vec3::from(v.position), Vec3::from(v.normal));
                assert!((n.length() - 1.0).abs() < 1e-5 && p.dot(n) > 0.0, "{v:?}");
            }
        }
    }
}
