//! Signed distance shapes and how they join: the sculpting tools of the mannequin.
//!
//! Distances are metres, negative inside. Only additions, products and square roots are used, so that every
//! machine makes the same mesh bit for bit. The formulas are the well-known ones of Quilez' distance functions.

use glam::Vec3;

/// A solid whose distance is known, in the frame of its body.
#[derive(Clone, Copy, Debug)]
pub(super) enum Shape {
    /// Two balls of radius `ra` at `a` and `rb` at `b` and everything between them.
    Cone { a: Vec3, b: Vec3, ra: f32, rb: f32 },
    /// Ellipsoid with half axes `radii`.
    Ellipsoid { centre: Vec3, radii: Vec3 },
    /// Box with half extents `half`, its edges rounded by `round` (inside the extents).
    Box { centre: Vec3, half: Vec3, round: f32 },
}

impl Shape {
    /// Distance from `p` to the surface, exact for cones and boxes, a close bound for ellipsoids.
    pub(super) fn distance(&self, p: Vec3) -> f32 {
        match *self {
            Shape::Cone { a, b, ra, rb } => cone(p, a, b, ra, rb),
            Shape::Ellipsoid { centre, radii } => {
                let q = p - centre;
                let k0 = (q / radii).length();
                let k1 = (q / (radii * radii)).length();
                if k1 < 1e-6 { -radii.min_element() } else { k0 * (k0 - 1.0) / k1 }
            }
            Shape::Box { centre, half, round } => {
                let q = (p - centre).abs() - (half - Vec3::splat(round));
                q.max(Vec3::ZERO).length() + q.max_element().min(0.0) - round
            }
        }
    }

    /// The shape mirrored from the right side of the body to the left (y to -y).
    pub(super) fn mirrored(self) -> Self {
        let flip = |v: Vec3| Vec3::new(v.x, -v.y, v.z);
        match self {
            Shape::Cone { a, b, ra, rb } => Shape::Cone { a: flip(a), b: flip(b), ra, rb },
            Shape::Ellipsoid { centre, radii } => Shape::Ellipsoid { centre: flip(centre), radii },
            Shape::Box { centre, half, round } => Shape::Box { centre: flip(centre), half, round },
        }
    }

    /// Lower and upper corner of a box that holds the shape.
    pub(super) fn bounds(&self) -> (Vec3, Vec3) {
        match *self {
            Shape::Cone { a, b, ra, rb } => {
                let r = Vec3::splat(ra.max(rb));
                (a.min(b) - r, a.max(b) + r)
            }
            Shape::Ellipsoid { centre, radii: half } | Shape::Box { centre, half, .. } => {
                (centre - half, centre + half)
            }
        }
    }
}

fn cone(p: Vec3, a: Vec3, b: Vec3, ra: f32, rb: f32) -> f32 {
    let axis = b - a;
    let length_squared = axis.length_squared();
    let difference = ra - rb;
    let slant_squared = length_squared - difference * difference;
    let inverse = 1.0 / length_squared;
    let from_a = p - a;
    let along = from_a.dot(axis);
    let beyond = along - length_squared;
    let radial = (from_a * length_squared - axis * along).length_squared();
    let along_squared = along * along * length_squared;
    let beyond_squared = beyond * beyond * length_squared;
    let k = sign(difference) * difference * difference * radial;
    if sign(beyond) * slant_squared * beyond_squared > k {
        (radial + beyond_squared).sqrt() * inverse - rb
    } else if sign(along) * slant_squared * along_squared < k {
        (radial + along_squared).sqrt() * inverse - ra
    } else {
        ((radial * slant_squared * inverse).sqrt() + along * difference) * inverse - ra
    }
}

fn sign(v: f32) -> f32 {
    if v > 0.0 {
        1.0
    } else if v < 0.0 {
        -1.0
    } else {
        0.0
    }
}

/// Union of two distances with a fillet of about `k` metres.
pub(super) fn smooth_union(a: f32, b: f32, k: f32) -> f32 {
    let h = (k - (a - b).abs()).max(0.0) / k;
    a.min(b) - h * h * k * 0.25
}

/// Outward unit normal of the field `distance` at `p`, by central differences.
pub(super) fn normal(p: Vec3, distance: impl Fn(Vec3) -> f32) -> Vec3 {
    const STEP: f32 = 5e-4;
    let along = |axis: Vec3| distance(p + axis * STEP) - distance(p - axis * STEP);
    Vec3::new(along(Vec3::X), along(Vec3::Y), along(Vec3::Z)).normalize_or(Vec3::Z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_agree_with_closed_forms() {
        let ball = Shape::Cone { a: Vec3::ZERO, b: Vec3::Z, ra: 0.2, rb: 0.2 };
        assert!((ball.distance(Vec3::new(0.5, 0.0, 0.5)) - 0.3).abs() < 1e-5);
        assert!((ball.distance(Vec3::new(0.0, 0.0, 1.5)) - 0.3).abs() < 1e-5);
        let cube = Shape::Box { centre: Vec3::ZERO, half: Vec3::splat(0.5), round: 0.1 };
        assert!((cube.distance(Vec3::new(0.8, 0.0, 0.0)) - 0.3).abs() < 1e-6);
        let round = Shape::Ellipsoid { centre: Vec3::ZERO, radii: Vec3::splat(0.4) };
        assert!((round.distance(Vec3::new(0.0, 1.0, 0.0)) - 0.6).abs() < 1e-5);
    }

    #[test]
    fn a_smooth_union_only_adds() {
        assert_eq!(smooth_union(0.3, 0.9, 0.1), 0.3);
        assert!((smooth_union(0.3, 0.3, 0.1) - 0.275).abs() < 1e-6);
    }
}
