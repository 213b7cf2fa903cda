//! Gives a shell a rim: where it comes down to what it covers, it ends in a step of a few millimetres.
//!
//! Two smooth surfaces that run into each other at a small angle meet in a ragged line, because each triangle ends a little too early or
//! too late. So the shell's mesh is cut along the exact curve where it stands [`RIM_M`] above what it covers. What lies beyond the curve is
//! sunk in, and a wall stands between both edges.

use glam::Vec3;

use super::field::normal;
use super::shell::{ByEdge, Point, Seek, Shell, ends, turned};
use super::surface_nets::Surface;

/// Height above what it covers at which a shell ends, metres.
const RIM_M: f32 = 0.004;
/// Height of the wall, metres: it reaches below the surface that it stands on.
const WALL_M: f32 = 0.010;
/// Steps that bring a point onto the curve.
const STEPS: usize = 8;

/// Where the curve crosses an edge of the mesh: the shell's own edge, the wall's upper edge, and the lower one.
#[derive(Clone, Copy)]
struct Crossing {
    top: u32,
    wall: u32,
    foot: u32,
}

/// The surface of `shell` with a rim where it stands on `covered`; both are distances, and `reach` is how far a point of the curve may lie
/// from the edge that it cuts.
pub(super) fn rimmed(
    surface: &Surface,
    reach: f32,
    shell: impl Fn(Vec3) -> f32,
    covered: impl Fn(Vec3) -> f32,
) -> Shell {
    let mut cut = Cut { out: Shell::of(surface, &shell), crossings: ByEdge::new(), reach, shell, covered };
    let heights: Vec<f32> = surface.positions.iter().map(|p| (cut.covered)(*p) - RIM_M).collect();
    cut.out.indices.clear();
    for (index, _) in heights.iter().enumerate().filter(|(_, height)| **height <= 0.0) {
        cut.out.points[index].position = cut.sunk(surface.positions[index]);
    }
    for corners in surface.indices.chunks_exact(3) {
        let ([a, b, c], first, others) = turned(corners, |corner| heights[corner as usize] > 0.0);
        if first == others {
            cut.out.indices.extend([a, b, c]);
            continue;
        }
        let [ab, ac] = [b, c].map(|other| cut.crossing(surface, &heights, a, other));
        let (tip, quad, wall) = if first {
            ([a, ab.top, ac.top], [ab.foot, b, c, ac.foot], [ac.wall, ab.wall, ab.foot, ac.foot])
        } else {
            ([a, ab.foot, ac.foot], [ab.top, b, c, ac.top], [ab.wall, ac.wall, ac.foot, ab.foot])
        };
        cut.out.indices.extend(tip);
        for [p, q, r, s] in [quad, wall] {
            cut.out.indices.extend([p, q, r, p, r, s]);
        }
    }
    cut.out
}

struct Cut<S, C> {
    out: Shell,
    crossings: ByEdge<Crossing>,
    reach: f32,
    shell: S,
    covered: C,
}

impl<S: Fn(Vec3) -> f32, C: Fn(Vec3) -> f32> Cut<S, C> {
    fn sunk(&self, p: Vec3) -> Vec3 {
        p - normal(p, &self.covered) * WALL_M
    }

    fn crossing(&mut self, surface: &Surface, heights: &[f32], a: u32, b: u32) -> Crossing {
        let ends = ends(a, b);
        if let Some(known) = self.crossings.get(&ends) {
            return *known;
        }
        let [(p, u), (q, v)] = [ends.0, ends.1].map(|i| (surface.positions[i as usize], heights[i as usize]));
        let seek = Seek { steps: STEPS, level: RIM_M, least_slope: 1e-3, reach: self.reach };
        let at = seek.from(p.lerp(q, u / (u - v)), true, &self.shell, &self.covered);
        let facing = normal(at, &self.shell);
        let up = normal(at, &self.covered);
        let outward = facing.reject_from_normalized(up).normalize_or(facing);
        let foot = at - up * WALL_M;
        let base = self.out.points.len() as u32;
        self.out.points.extend(
            [(at, facing), (at, outward), (foot, outward)]
                .map(|(position, normal)| Point { position, normal }),
        );
        let new = Crossing { top: base, wall: base + 1, foot: base + 2 };
        self.crossings.insert(ends, new);
        new
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::super::surface_nets;
    use super::*;

    /// A flat ball over a floor, which comes down to it at an angle of about 17 degrees.
    fn lens() -> (impl Fn(Vec3) -> f32, impl Fn(Vec3) -> f32) {
        (|p: Vec3| (p + Vec3::Z * 0.18).length() - 0.2, |p: Vec3| p.z)
    }

    fn made(cell: f32) -> Shell {
        let (shell, floor) = lens();
        let surface = surface_nets::mesh(Vec3::splat(-0.4), Vec3::splat(0.3), cell, &shell);
        rimmed(&surface, cell, shell, floor)
    }

    #[test]
    fn the_shell_ends_on_a_smooth_curve_above_what_it_covers() {
        let rimmed = made(0.02);
        let walls = rimmed.points.iter().filter(|p| p.normal.z.abs() < 1e-3 && p.position.z > 0.0);
        let radii: Vec<f32> = walls.map(|p| p.position.truncate().length()).collect();
        // The circle in which the ball is 4 mm above the floor.
        let exact = (0.2_f32.powi(2) - 0.184_f32.powi(2)).sqrt();
        assert!(radii.len() > 20 && radii.iter().all(|r| (r - exact).abs() < 2e-4), "{exact}: {radii:?}");
    }

    #[test]
    fn nothing_lies_between_the_rim_and_what_it_covers() {
        let between = |p: &Point| p.position.z > -0.005 && p.position.z < RIM_M - 1e-4;
        let count = made(0.02).points.iter().filter(|p| between(p)).count();
        assert_eq!(count, 0);
    }

    #[test]
    fn it_stays_closed() {
        let rimmed = made(0.02);
        // The edges of top and wall lie in one place but are two vertices each: compare places.
        let place = |i: u32| rimmed.points[i as usize].position.to_array().map(f32::to_bits);
        let mut edges = HashMap::new();
        for t in rimmed.indices.chunks_exact(3) {
            for (from, to) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
                let (from, to) = (place(from), place(to));
                *edges.entry((from.min(to), from.max(to))).or_insert(0) += if from < to { 1 } else { -1 };
            }
        }
        let open: Vec<_> = edges
            .iter()
            .filter(|(_, sum)| **sum != 0)
            .map(|((a, b), s)| (a.map(f32::from_bits), b.map(f32::from_bits), *s))
            .collect();
        assert!(open.is_empty(), "open edges: {open:?}");
    }
}
