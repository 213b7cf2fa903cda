//! Surfaces of the shells: points with normals, and what cutting them along a curve needs.

use std::collections::BTreeMap;

use glam::Vec3;

use super::field::normal;
use super::surface_nets::Surface;

/// A point of a shell and the way it faces.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    pub(super) position: Vec3,
    pub(super) normal: Vec3,
}

/// Triangles of a shell, wound counter-clockwise seen from outside.
#[derive(Default)]
pub(super) struct Shell {
    pub(super) points: Vec<Point>,
    pub(super) indices: Vec<u32>,
}

impl Shell {
    /// The surface of `distance` as it is.
    pub(super) fn of(surface: &Surface, distance: impl Fn(Vec3) -> f32) -> Self {
        let point = |&position: &Vec3| Point { position, normal: normal(position, &distance) };
        Self { points: surface.positions.iter().map(point).collect(), indices: surface.indices.clone() }
    }
}

/// What was made of each edge of a mesh, whichever triangle asked for it first; by its ends, the lower one first.
pub(super) type ByEdge<T> = BTreeMap<(u32, u32), T>;

/// The ends of an edge, the lower one first.
pub(super) fn ends(a: u32, b: u32) -> (u32, u32) {
    (a.min(b), a.max(b))
}

/// The corners of a triangle, turned so that the one that is alone on its side comes first, and the sides of that one and of the others.
pub(super) fn turned(corners: &[u32], is_inside: impl Fn(u32) -> bool) -> ([u32; 3], bool, bool) {
    let inside = [0, 1, 2].map(|i| is_inside(corners[i]));
    let first = (0..3).find(|i| inside[(i + 1) % 3] == inside[(i + 2) % 3]).unwrap_or(0);
    ([0, 1, 2].map(|i| corners[(first + i) % 3]), inside[first], inside[(first + 1) % 3])
}

/// The `vertices` that the triangles use, in the order of their first use, and the triangles with the new indices.
pub(super) fn used<T: Copy>(vertices: &[T], indices: impl Iterator<Item = u32>) -> (Vec<T>, Vec<u32>) {
    let mut place = vec![u32::MAX; vertices.len()];
    let mut kept = Vec::new();
    let indices = indices.map(|index| {
        let at = &mut place[index as usize];
        if *at == u32::MAX {
            *at = kept.len() as u32;
            kept.push(vertices[index as usize]);
        }
        *at
    });
    let indices = indices.collect();
    (kept, indices)
}

/// How a point is brought onto the curve on a shell at a distance to another surface: by Newton steps on both distances.
pub(super) struct Seek {
    /// Steps.
    pub(super) steps: usize,
    /// Distance to the other surface on the curve, metres.
    pub(super) level: f32,
    /// Least square of the sine of the angle between the surfaces at which a step along the shell is taken.
    pub(super) least_slope: f32,
    /// Furthest that the point may be from the start, metres.
    pub(super) reach: f32,
}

impl Seek {
    /// The point near `start` at that distance to `other`; `start` where the steps lead away. One `on_shell` is kept on the surface of `shell`,
    /// another one keeps its height over it.
    pub(super) fn from(
        &self,
        start: Vec3,
        on_shell: bool,
        shell: impl Fn(Vec3) -> f32,
        other: impl Fn(Vec3) -> f32,
    ) -> Vec3 {
        let mut p = start;
        for _ in 0..self.steps {
            let n = normal(p, &shell);
            if on_shell {
                p -= n * shell(p);
            }
            let along = normal(p, &other).reject_from_normalized(n);
            let slope = along.length_squared();
            if slope > self.least_slope {
                p -= along * ((other(p) - self.level) / slope);
            }
        }
        if p.distance(start) <= self.reach { p } else { start }
    }
}
