//! Turns a distance field into triangles: naive surface nets (Gibson 1998), one vertex for each grid cell that
//! the surface passes through, then pulled onto the surface along the gradient.

use glam::{IVec3, Vec3};

use super::field::normal;

/// Triangles of a surface, wound counter-clockwise seen from outside.
#[derive(Default)]
pub(super) struct Surface {
    pub(super) positions: Vec<Vec3>,
    pub(super) indices: Vec<u32>,
}

/// Meshes the zero surface of `distance` inside the box `low..high` with cubic cells of edge `cell`.
pub(super) fn mesh(low: Vec3, high: Vec3, cell: f32, distance: impl Fn(Vec3) -> f32) -> Surface {
    let low = low - Vec3::splat(1.5 * cell);
    let size = ((high - low) / cell).ceil().as_ivec3() + IVec3::splat(3);
    let index = |c: IVec3| ((c.z * size.y + c.y) * size.x + c.x) as usize;
    let corner = |c: IVec3| low + c.as_vec3() * cell;
    let values: Vec<f32> = cells(size).map(|c| distance(corner(c))).collect();

    let mut surface = Surface::default();
    let mut vertex_of = vec![u32::MAX; values.len()];
    for c in cells(size - IVec3::ONE) {
        if let Some(inside_cell) = crossing(|offset| values[index(c + offset)]) {
            vertex_of[index(c)] = surface.positions.len() as u32;
            let start = corner(c) + inside_cell * cell;
            surface.positions.push(pull(start, 0.6 * cell, &distance));
        }
    }
    for c in cells(size - IVec3::ONE) {
        let here = values[index(c)];
        for axis in 0..3 {
            let step = IVec3::AXES[axis];
            let (u, v) = (IVec3::AXES[(axis + 1) % 3], IVec3::AXES[(axis + 2) % 3]);
            let there = values[index(c + step)];
            if (here < 0.0) == (there < 0.0) || c.dot(u) == 0 || c.dot(v) == 0 {
                continue;
            }
            let quad = [c - u - v, c - v, c, c - u].map(|c| vertex_of[index(c)]);
            let [q0, q1, q2, q3] = if here < 0.0 { quad } else { [quad[3], quad[2], quad[1], quad[0]] };
            push_quad(&mut surface, [q0, q1, q2, q3]);
        }
    }
    surface
}

fn cells(size: IVec3) -> impl Iterator<Item = IVec3> {
    (0..size.z)
        .flat_map(move |z| (0..size.y).flat_map(move |y| (0..size.x).map(move |x| IVec3::new(x, y, z))))
}

/// Mean of the points where the surface crosses the cell's edges, in cell units; `None` when it does not.
fn crossing(value: impl Fn(IVec3) -> f32) -> Option<Vec3> {
    let mut sum = Vec3::ZERO;
    let mut count = 0;
    for axis in 0..3 {
        let (u, v) = (IVec3::AXES[(axis + 1) % 3], IVec3::AXES[(axis + 2) % 3]);
        for start in [IVec3::ZERO, u, v, u + v] {
            let (a, b) = (value(start), value(start + IVec3::AXES[axis]));
            if (a < 0.0) != (b < 0.0) {
                sum += start.as_vec3() + Vec3::AXES[axis] * (a / (a - b));
                count += 1;
            }
        }
    }
    (count > 0).then(|| sum / count as f32)
}

/// Newton steps along the gradient, never further than `reach` from the start.
fn pull(start: Vec3, reach: f32, distance: &impl Fn(Vec3) -> f32) -> Vec3 {
    let mut p = start;
    for _ in 0..4 {
        p -= normal(p, distance) * distance(p);
    }
    let moved = p - start;
    if moved.length() <= reach { p } else { start + moved.normalize_or_zero() * reach }
}

/// Splits the quad along its shorter diagonal.
fn push_quad(surface: &mut Surface, q: [u32; 4]) {
    let p = q.map(|i| surface.positions[i as usize]);
    let split = if p[0].distance_squared(p[2]) <= p[1].distance_squared(p[3]) {
        [q[0], q[1], q[2], q[0], q[2], q[3]]
    } else {
        [q[0], q[1], q[3], q[1], q[2], q[3]]
    };
    surface.indices.extend(split);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ball_is_closed_round_and_faces_outwards() {
        let surface = mesh(Vec3::splat(-0.5), Vec3::splat(0.5), 0.07, |p| p.length() - 0.5);
        assert!(surface.positions.iter().all(|p| (p.length() - 0.5).abs() < 1e-3));
        let mut volume = 0.0;
        let mut edges = std::collections::HashMap::new();
        for t in surface.indices.chunks_exact(3) {
            let [a, b, c] = [0, 1, 2].map(|i| surface.positions[t[i] as usize]);
            volume += a.dot(b.cross(c)) / 6.0;
            for (from, to) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
                *edges.entry((from.min(to), from.max(to))).or_insert(0) += if from < to { 1 } else { -1 };
            }
        }
        assert!(edges.values().all(|&sum| sum == 0), "an edge is open");
        let ball = 4.0 / 3.0 * std::f32::consts::PI * 0.125;
        assert!((volume / ball - 1.0).abs() < 0.05, "volume {volume}, ball {ball}");
    }
}
