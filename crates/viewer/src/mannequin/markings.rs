//! Dark markings on the shells, by which one sees how the body and its limbs turn: a line down the back of head and chest, a badge on
//! the left of the chest, lines on the outer sides of the limbs, and a band around the left upper arm.

use glam::{Vec3, vec3};

use super::bone::Bone;
use super::field::{Shape, normal};
use super::shell::{ByEdge, Point, Seek, Shell, ends, turned, used};

/// Longest edge of a triangle at the edge of a marking, metres.
const LONGEST_M: f32 = 0.017;
/// What is nearer to the shell's surface than this lies on it, metres; walls of rims lie off it, and stay there.
const ON_SHELL_M: f32 = 0.002;
/// How a point is brought onto the edge of a marking.
const SEEK: Seek = Seek { steps: 6, level: 0.0, least_slope: 0.05, reach: 0.01 };

fn block(centre: Vec3, half: Vec3) -> Shape {
    Shape::Box { centre, half, round: 0.45 * half.min_element() }
}

/// What is marked on the shells of a body: all of its surface inside of these shapes, in its frame.
pub(super) fn of(body: Bone) -> Vec<Shape> {
    let outer = |z: f32, half: Vec3| vec![block(vec3(0.0, -0.08, z), half)];
    let right = |body: Bone| match body {
        Bone::RightUpperArm => outer(-0.140, vec3(0.010, 0.07, 0.055)),
        Bone::RightLowerArm => outer(-0.13, vec3(0.009, 0.07, 0.05)),
        Bone::RightThigh => outer(-0.215, vec3(0.012, 0.07, 0.10)),
        Bone::RightShin => outer(-0.20, vec3(0.011, 0.07, 0.085)),
        _ => Vec::new(),
    };
    let mut shapes = match body {
        Bone::Head => vec![block(vec3(-0.1, 0.0, 0.22), vec3(0.1, 0.010, 0.10))],
        Bone::Torso => vec![
            block(vec3(-0.1, 0.0, 0.12), vec3(0.1, 0.012, 0.13)),
            Shape::Ellipsoid { centre: vec3(0.12, 0.062, 0.185), radii: vec3(0.1, 0.032, 0.015) },
        ],
        Bone::LeftUpperArm | Bone::LeftLowerArm | Bone::LeftThigh | Bone::LeftShin => {
            right(body.mirrored()).into_iter().map(Shape::mirrored).collect()
        }
        _ => right(body),
    };
    if body == Bone::LeftUpperArm {
        shapes.push(block(Vec3::NEG_Z * 0.065, vec3(0.1, 0.1, 0.012)));
    }
    shapes
}

/// Parts a surface along the edge of its markings; returns what is not marked and what is.
pub(super) fn parted(whole: Shell, shapes: &[Shape], shell: impl Fn(Vec3) -> f32) -> (Shell, Shell) {
    if shapes.is_empty() {
        return (whole, Shell::default());
    }
    let marking = |p: Vec3| shapes.iter().map(|shape| shape.distance(p)).fold(f32::INFINITY, f32::min);
    let whole = refined(refined(whole, &marking, &shell), &marking, &shell);
    let mut points = whole.points;
    let distances: Vec<f32> = points.iter().map(|point| marking(point.position)).collect();
    let mut crossings = ByEdge::new();
    let mut crossing = |a: u32, b: u32| {
        let ends = ends(a, b);
        *crossings.entry(ends).or_insert_with(|| {
            let [d, e] = [ends.0, ends.1].map(|end| distances[end as usize]);
            let between = between(&points, ends, d / (d - e));
            let on_shell = shell(between.position).abs() < ON_SHELL_M;
            let position = SEEK.from(between.position, on_shell, &shell, marking);
            points.push(Point { position, ..between });
            points.len() as u32 - 1
        })
    };
    let mut sides = [Vec::new(), Vec::new()];
    for corners in whole.indices.chunks_exact(3) {
        let ([a, b, c], tip, rest) = turned(corners, |corner| distances[corner as usize] < 0.0);
        if tip == rest {
            sides[usize::from(tip)].extend([a, b, c]);
            continue;
        }
        let (ab, ac) = (crossing(a, b), crossing(a, c));
        sides[usize::from(tip)].extend([a, ab, ac]);
        sides[usize::from(rest)].extend([ab, b, c, ab, c, ac]);
    }
    let [plain, marked] = sides.map(|indices| {
        let (points, indices) = used(&points, indices.into_iter());
        Shell { points, indices }
    });
    (plain, marked)
}

/// The point that is a share of the way along an edge.
fn between(points: &[Point], ends: (u32, u32), share: f32) -> Point {
    let [p, q] = [ends.0, ends.1].map(|end| points[end as usize]);
    let normal = p.normal.lerp(q.normal, share).normalize_or(p.normal);
    Point { position: p.position.lerp(q.position, share), normal }
}

/// The surface with long edges near the marking's edge halved: a triangle that is wider than a line would lose it.
fn refined(whole: Shell, marking: &impl Fn(Vec3) -> f32, shell: &impl Fn(Vec3) -> f32) -> Shell {
    let mut points = whole.points;
    let mut halves = ByEdge::new();
    let mut half_of = |a: u32, b: u32| {
        let ends = ends(a, b);
        *halves.entry(ends).or_insert_with(|| {
            let [p, q] = [ends.0, ends.1].map(|end| points[end as usize].position);
            let (mut half, length) = (between(&points, ends, 0.5), p.distance(q));
            (length > LONGEST_M && marking(half.position).abs() < 0.6 * length).then(|| {
                let height = shell(half.position);
                if height.abs() < ON_SHELL_M {
                    half.position -= normal(half.position, shell) * height;
                }
                points.push(half);
                points.len() as u32 - 1
            })
        })
    };
    let mut indices = Vec::with_capacity(whole.indices.len());
    for corners in whole.indices.chunks_exact(3) {
        let halves = [0, 1, 2].map(|i| half_of(corners[i], corners[(i + 1) % 3]));
        // The corners with the halves between them, all around; cut into triangles from one half, or from a corner where there is none.
        let ring: Vec<u32> = (0..3).flat_map(|i| [Some(corners[i]), halves[i]]).flatten().collect();
        match halves {
            [Some(x), Some(y), Some(z)] => {
                let [a, b, c] = [0, 1, 2].map(|i| corners[i]);
                indices.extend([a, x, z, x, b, y, z, y, c, x, y, z]);
            }
            _ => {
                let from = ring.iter().position(|at| halves.contains(&Some(*at))).unwrap_or(0);
                let at = |i: usize| ring[(from + i) % ring.len()];
                (1..ring.len() - 1).for_each(|i| indices.extend([at(0), at(i), at(i + 1)]));
            }
        }
    }
    Shell { points, indices }
}

#[cfg(test)]
mod tests {
    use super::super::surface_nets;
    use super::*;

    /// A ball of 0.1 m with a belt around its equator, in cells of this edge: what is not marked, what is, and the share that is.
    fn belted(half_width: f32, cell: f32) -> (Shell, Shell, f32) {
        let ball = |p: Vec3| p.length() - 0.1;
        let surface = surface_nets::mesh(Vec3::splat(-0.1), Vec3::splat(0.1), cell, ball);
        let belt = [Shape::Box { centre: Vec3::ZERO, half: vec3(0.5, 0.5, half_width), round: 0.001 }];
        let (plain, marked) = parted(Shell::of(&surface, ball), &belt, ball);
        let share = area(&marked) / (area(&marked) + area(&plain));
        (plain, marked, share)
    }

    fn area(part: &Shell) -> f32 {
        let at = |i: u32| part.points[i as usize].position;
        let triangles = part.indices.chunks_exact(3);
        triangles.map(|t| 0.5 * (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])).length()).sum()
    }

    #[test]
    fn a_marking_takes_its_share_of_a_ball_and_has_a_straight_edge() {
        // A belt of h = 40 mm has an area of 2 pi r h, a fifth of the ball's 4 pi r^2.
        let (plain, marked, share) = belted(0.02, 0.02);
        assert!((share - 0.2).abs() < 0.01, "{share}");
        let over = marked.points.iter().map(|p| p.position.z.abs()).fold(0.0, f32::max);
        let under = plain.points.iter().map(|p| p.position.z.abs()).fold(1.0, f32::min);
        assert!((over - 0.02).abs() < 1e-4 && (under - 0.02).abs() < 1e-4, "{over} {under}");
    }

    #[test]
    fn a_line_narrower_than_the_triangles_is_kept() {
        let (_, _, share) = belted(0.008, 0.035);
        assert!((share - 0.08).abs() < 0.01, "{share}");
    }
}
