//! Joint angles of local rotations, for any skeleton: one hinge of a body in closed form, three about its axes as Euler angles,
//! other sets by search.
//!
//! Euler angles have two solutions. The one inside the limits and nearest to the frame before is taken, then clamped, so that a
//! demonstration is a pose that the character can reach.

use std::f32::consts::{PI, TAU};

use glam::{EulerRot, Mat3, Quat, Vec3};
use policy_core::Skeleton;

use crate::ClipError;
use crate::error::find_body;

/// Rounds of the search for the angles of a body with other hinges.
const SEARCH_ROUNDS: usize = 20;

/// How the angles of one body's hinges follow from its rotation.
#[derive(Clone, Debug)]
enum Solve {
    /// One hinge about this axis.
    Hinge(Vec3),
    /// Three hinges about the axes of the body, in this order and with these signs.
    Ball(EulerRot, [f32; 3]),
    /// Any hinges about these axes.
    Search(Vec<Vec3>),
}

/// The hinges of one body.
#[derive(Clone, Debug)]
struct BodyFit {
    /// Index of the body in the clip.
    source: usize,
    /// Indices of the hinges in the skeleton.
    joints: Vec<usize>,
    solve: Solve,
}

/// Turns local rotations into joint angles, frame after frame.
#[derive(Clone, Debug)]
pub struct JointFit {
    bodies: Vec<BodyFit>,
    ranges: Vec<[f32; 2]>,
    before: Vec<f32>,
    worst: Vec<f32>,
}

impl JointFit {
    /// A fit of clips with these bodies to a skeleton. Bodies of the clip that the skeleton lacks are left out.
    ///
    /// # Errors
    /// When the clip lacks a body of the skeleton that has hinges; `clip` is named.
    pub fn new(skeleton: &Skeleton, clip: &str, bodies: &[String]) -> Result<Self, ClipError> {
        let mut fits = Vec::new();
        for &id in skeleton.jointed_bodies() {
            let name = &skeleton.body(id).name;
            let source = find_body(clip, bodies, name)?;
            let of_body = skeleton.joints().iter().enumerate().filter(|(_, joint)| joint.body == id);
            let (joints, axes) = of_body.map(|(index, joint)| (index, joint.axis.normalize())).unzip();
            fits.push(BodyFit { source, joints, solve: solve(axes) });
        }
        let ranges: Vec<_> = skeleton.joints().iter().map(|joint| joint.range).collect();
        let zeros = vec![0.0; ranges.len()];
        Ok(Self { bodies: fits, ranges, before: zeros.clone(), worst: zeros })
    }

    /// How far any frame lay outside the limits before clamping, radians, and the index of that joint.
    #[must_use]
    pub fn worst(&self) -> (f32, usize) {
        let joints = 0..self.worst.len();
        let worst = joints.max_by(|a, b| self.worst[*a].total_cmp(&self.worst[*b])).unwrap_or(0);
        (self.worst.get(worst).copied().unwrap_or(0.0), worst)
    }

    /// Joint angles of one frame, radians, within the limits, in the order of the skeleton.
    ///
    /// # Panics
    /// When there are fewer rotations than bodies of the clip.
    pub fn angles(&mut self, local_rotations: &[Quat]) -> Vec<f32> {
        let mut angles = vec![0.0; self.ranges.len()];
        for body in &self.bodies {
            let found = self.angles_of(body, local_rotations[body.source]);
            body.joints.iter().zip(found).for_each(|(joint, angle)| angles[*joint] = angle);
        }
        for (joint, angle) in angles.iter_mut().enumerate() {
            self.worst[joint] = self.worst[joint].max(self.outside(joint, *angle));
            // A skeleton's ranges are finite and ascend, which `clamp` needs; all lists have one entry a joint.
            let [low, high] = self.ranges[joint];
            *angle = angle.clamp(low, high);
        }
        self.before.clone_from(&angles);
        angles
    }

    fn angles_of(&self, body: &BodyFit, rotation: Quat) -> Vec<f32> {
        match &body.solve {
            Solve::Hinge(axis) => vec![wrap(2.0 * rotation.xyz().dot(*axis).atan2(rotation.w))],
            Solve::Ball(order, signs) => {
                let (a, b, c) = rotation.to_euler(*order);
                let signed = |angles: [f32; 3]| -> Vec<f32> {
                    angles.iter().zip(signs).map(|(angle, sign)| angle * sign).collect()
                };
                let (first, second) = (signed([a, b, c]), signed([wrap(a + PI), wrap(PI - b), wrap(c + PI)]));
                if self.cost(body, &second) < self.cost(body, &first) { second } else { first }
            }
            Solve::Search(axes) => {
                let mut angles: Vec<f32> = body.joints.iter().map(|joint| self.before[*joint]).collect();
                (0..SEARCH_ROUNDS).for_each(|_| descend(axes, rotation, &mut angles));
                angles
            }
        }
    }

    fn outside(&self, joint: usize, angle: f32) -> f32 {
        let [low, high] = self.ranges[joint];
        (low - angle).max(angle - high).max(0.0)
    }

    fn cost(&self, body: &BodyFit, angles: &[f32]) -> f32 {
        let part = |(joint, angle): (&usize, &f32)| {
            self.outside(*joint, *angle) + wrap(angle - self.before[*joint]).abs()
        };
        body.joints.iter().zip(angles).map(part).sum()
    }
}

/// How to solve for hinges about these axes.
fn solve(axes: Vec<Vec3>) -> Solve {
    // The axis of the body that a hinge turns about, and its sign.
    let principal = |axis: &Vec3| {
        let index = (0..3).find(|i| axis[*i].abs() > 1.0 - 1e-5)?;
        Some((index, axis[index].signum()))
    };
    let found: Option<Vec<_>> = axes.iter().map(principal).collect();
    match (&axes[..], found.as_deref()) {
        ([axis], _) => Solve::Hinge(*axis),
        (_, Some(&[(a, x), (b, y), (c, z)])) => match order([a, b, c]) {
            Some(order) => Solve::Ball(order, [x, y, z]),
            None => Solve::Search(axes),
        },
        _ => Solve::Search(axes),
    }
}

/// The order of rotations about three different axes.
fn order(axes: [usize; 3]) -> Option<EulerRot> {
    Some(match axes {
        [0, 1, 2] => EulerRot::XYZ,
        [0, 2, 1] => EulerRot::XZY,
        [1, 0, 2] => EulerRot::YXZ,
        [1, 2, 0] => EulerRot::YZX,
        [2, 0, 1] => EulerRot::ZXY,
        [2, 1, 0] => EulerRot::ZYX,
        _ => return None,
    })
}

/// One step of the angles towards a rotation, along the gradient of the angle between the two.
fn descend(axes: &[Vec3], rotation: Quat, angles: &mut [f32]) {
    let reached = |angles: &[f32]| -> Quat {
        axes.iter().zip(angles).map(|(axis, angle)| Quat::from_axis_angle(*axis, *angle)).product()
    };
    let mut left = rotation * reached(angles).inverse();
    if left.w < 0.0 {
        left = -left;
    }
    let error = left.to_scaled_axis();
    // World axis of every hinge as it is now; the least squares of their turns that make up for the error.
    let mut before = Quat::IDENTITY;
    let turned: Vec<Vec3> = axes
        .iter()
        .zip(&*angles)
        .map(|(axis, angle)| {
            let now = before * *axis;
            before *= Quat::from_axis_angle(*axis, *angle);
            now
        })
        .collect();
    let mut normal = Mat3::from_diagonal(Vec3::splat(1e-3));
    for axis in &turned {
        normal += Mat3::from_cols(*axis * axis.x, *axis * axis.y, *axis * axis.z);
    }
    let dual = normal.inverse() * error;
    angles.iter_mut().zip(&turned).for_each(|(angle, axis)| *angle = wrap(*angle + axis.dot(dual)));
}

/// The same angle in (-pi, pi].
fn wrap(angle: f32) -> f32 {
    angle - TAU * (angle / TAU).round()
}

#[cfg(test)]
mod tests {
    use policy_core::BodyId;
    use policy_core::training::{Roles, SkeletonBody, SkeletonJoint};

    use super::*;

    /// Two bodies; the second hangs on hinges about these axes.
    fn skeleton(axes: &[Vec3]) -> Skeleton {
        let body = |name: &str, parent| SkeletonBody { name: name.into(), parent };
        let joint = |(i, axis): (usize, &Vec3)| SkeletonJoint {
            name: format!("j{i}"),
            body: BodyId::new(1),
            axis: *axis,
            range: [-3.0, 3.0],
        };
        let bodies = vec![body("root", None), body("limb", Some(BodyId::new(0)))];
        Skeleton::from_parts(bodies, axes.iter().enumerate().map(joint).collect(), Roles::default()).unwrap()
    }

    #[test]
    fn angles_give_the_rotation_back_for_any_hinges() {
        let slanted = Vec3::new(1.0, 1.0, 0.0).normalize();
        for axes in [
            vec![Vec3::Y],
            vec![Vec3::NEG_Y],
            vec![slanted],
            vec![Vec3::Y, Vec3::X, Vec3::Z],
            vec![Vec3::NEG_Z, Vec3::X, Vec3::NEG_Y],
            vec![Vec3::X, Vec3::Y],
            vec![slanted, Vec3::Z],
            vec![Vec3::X, slanted, Vec3::Z],
        ] {
            let names = ["limb".to_owned(), "tail".to_owned()];
            let mut fit = JointFit::new(&skeleton(&axes), "clip", &names).unwrap();
            for turn in 0..30 {
                let wanted: Vec<f32> =
                    (0..axes.len()).map(|i| 0.9 * (0.21 * turn as f32 + i as f32).sin()).collect();
                let rotation = |angles: &[f32]| -> Quat {
                    axes.iter().zip(angles).map(|(axis, a)| Quat::from_axis_angle(*axis, *a)).product()
                };
                let found = fit.angles(&[rotation(&wanted), Quat::IDENTITY]);
                let apart = rotation(&found).angle_between(rotation(&wanted));
                assert!(apart < 5e-3, "{axes:?}, {wanted:?}: {found:?}, {apart}");
            }
            assert!(fit.worst().0 < 1e-6);
        }
    }

    #[test]
    fn a_clip_without_a_jointed_body_is_refused() {
        let error = JointFit::new(&skeleton(&[Vec3::Y]), "walk", &["root".to_owned()]).unwrap_err();
        assert!(error.to_string().contains("limb"), "{error}");
    }
}
