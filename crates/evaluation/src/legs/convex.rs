//! Distances between segments and boxes.

use glam::Vec3;

/// Steps of a search along a segment; each leaves 0.62 of the rest.
const SEARCH_STEPS: u32 = 24;

/// Distance between two segments, each by its ends, metres.
pub(super) fn segment_distance([a, b]: [Vec3; 2], [c, d]: [Vec3; 2]) -> f32 {
    // The distance to a segment is a convex function of the point, so its least along another is found by search.
    least_along([a, b], |point| point_segment_distance(point, [c, d]))
}

fn point_segment_distance(point: Vec3, [a, b]: [Vec3; 2]) -> f32 {
    let along = b - a;
    let t = (point - a).dot(along) / along.length_squared().max(1e-12);
    point.distance(a + along * t.clamp(0.0, 1.0))
}

/// Least value of a convex function along a segment, by golden-section search.
pub(super) fn least_along([a, b]: [Vec3; 2], value: impl Fn(Vec3) -> f32) -> f32 {
    const GOLDEN: f32 = 0.618_034;
    let at = |t: f32| value(a + (b - a) * t);
    let (mut low, mut high) = (0.0, 1.0);
    let mut least = at(0.0).min(at(1.0));
    for _ in 0..SEARCH_STEPS {
        let (left, right) = (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
        let (at_left, at_right) = (at(left), at(right));
        least = least.min(at_left).min(at_right);
        if at_left < at_right { high = right } else { low = left }
    }
    least
}

/// Signed distance of a point, in the frame of a box, to its surface; negative inside. A convex function of the point.
pub(super) fn box_distance(point: Vec3, half_extents: Vec3) -> f32 {
    let outside = point.abs() - half_extents;
    outside.max(Vec3::ZERO).length() + outside.max_element().min(0.0)
}

/// How far two boxes have to move to be apart, metres; negative when they are. Each is its centre, its axes times its half
/// extents. Separating axes: exact where they overlap, a lower bound of the distance where they do not.
pub(super) fn box_depth((centre, axes): (Vec3, [Vec3; 3]), (other, others): (Vec3, [Vec3; 3])) -> f32 {
    let between = other - centre;
    let extent = |axes: &[Vec3; 3], along: Vec3| axes.iter().map(|axis| axis.dot(along).abs()).sum::<f32>();
    let crosses = axes.iter().flat_map(|a| others.iter().map(move |b| a.cross(*b)));
    let directions = axes.iter().chain(&others).copied().chain(crosses);
    directions
        .filter_map(Vec3::try_normalize)
        .map(|along| extent(&axes, along) + extent(&others, along) - between.dot(along).abs())
        .fold(f32::INFINITY, f32::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_that_cross_above_each_other_are_their_gap_apart() {
        let along = [Vec3::new(-1.0, 0.0, 0.0), Vec3::new(1.0, 0.0, 0.0)];
        let across = [Vec3::new(0.3, -2.0, 0.25), Vec3::new(0.3, 1.0, 0.25)];
        assert!((segment_distance(along, across) - 0.25).abs() < 1e-4);
        let beyond = [Vec3::new(4.0, 1.0, 0.0), Vec3::new(4.0, 4.0, 0.0)];
        assert!((segment_distance(along, beyond) - 10.0_f32.sqrt()).abs() < 1e-4);
        assert!((segment_distance(along, along)).abs() < 1e-6);
        let point = [Vec3::new(0.0, 0.5, 0.0); 2];
        assert!((segment_distance(along, point) - 0.5).abs() < 1e-4);
    }

    #[test]
    fn the_distance_to_a_box_is_negative_inside() {
        let half = Vec3::new(1.0, 2.0, 3.0);
        assert!((box_distance(Vec3::new(0.7, 0.0, 0.0), half) + 0.3).abs() < 1e-6);
        assert!((box_distance(Vec3::new(4.0, 6.0, 0.0), half) - 5.0).abs() < 1e-6);
        assert!(box_distance(Vec3::new(1.0, 0.5, 0.5), half).abs() < 1e-6);
    }

    #[test]
    fn boxes_overlap_by_what_they_have_to_move() {
        let unit = [Vec3::X, Vec3::Y, Vec3::Z];
        let depth = |centre: Vec3, axes| box_depth((Vec3::ZERO, unit), (centre, axes));
        assert!((depth(Vec3::new(1.75, 0.3, 0.1), unit) - 0.25).abs() < 1e-6);
        assert!((depth(Vec3::new(0.0, 2.5, 0.0), unit) + 0.5).abs() < 1e-6);
        // Turned by 45 degrees about z, an edge points at the first box.
        let turn = glam::Quat::from_rotation_z(std::f32::consts::FRAC_PI_4);
        let turned = unit.map(|axis| turn * axis);
        assert!((depth(Vec3::new(2.0, 0.0, 0.0), turned) - (2.0_f32.sqrt() - 1.0)).abs() < 1e-5);
        // A face of the turned box lies between the two, though no face of the other does.
        let tilt = glam::Quat::from_rotation_arc(Vec3::X, Vec3::new(1.0, 1.0, 0.0).normalize());
        let rotated = unit.map(|axis| tilt * axis);
        assert!(depth(Vec3::new(1.9, 1.9, 0.0), rotated) < 0.0);
    }
}
