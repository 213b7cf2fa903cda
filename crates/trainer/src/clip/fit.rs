//! Joint angles of local rotations: hinges about y, ball joints as three hinges in the order of the model.
//!
//! A ball joint has two solutions for its three angles; the one inside the limits and nearest to the frame before
//! is taken, then clamped, so that a demonstration is a pose the character can reach.

use glam::{EulerRot, Quat};
use policy_core::{BODY_COUNT, Body, DOF_COUNT, JOINT_NAMES};

use std::f32::consts::{PI, TAU};

/// Limits of the joints in radians, in the order of [`JOINT_NAMES`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointLimits {
    /// Lowest angles.
    pub low: [f32; DOF_COUNT],
    /// Highest angles.
    pub high: [f32; DOF_COUNT],
}

/// Joints of one body.
#[derive(Clone, Copy)]
enum Joint {
    Hinge,
    Ball(EulerRot),
}

const JOINTS: [(Body, Joint); 12] = [
    (Body::Torso, Joint::Ball(EulerRot::XYZ)),
    (Body::Head, Joint::Ball(EulerRot::XYZ)),
    (Body::RightUpperArm, Joint::Ball(EulerRot::YXZ)),
    (Body::RightLowerArm, Joint::Hinge),
    (Body::LeftUpperArm, Joint::Ball(EulerRot::YXZ)),
    (Body::LeftLowerArm, Joint::Hinge),
    (Body::RightThigh, Joint::Ball(EulerRot::YXZ)),
    (Body::RightShin, Joint::Hinge),
    (Body::RightFoot, Joint::Ball(EulerRot::XYZ)),
    (Body::LeftThigh, Joint::Ball(EulerRot::YXZ)),
    (Body::LeftShin, Joint::Hinge),
    (Body::LeftFoot, Joint::Ball(EulerRot::XYZ)),
];

/// Turns local rotations into joint angles, frame after frame.
#[derive(Clone, Debug)]
pub struct JointFit {
    limits: JointLimits,
    before: [f32; DOF_COUNT],
    worst: [f32; DOF_COUNT],
}

impl JointFit {
    /// A fit to these limits.
    #[must_use]
    pub fn new(limits: JointLimits) -> Self {
        Self { limits, before: [0.0; DOF_COUNT], worst: [0.0; DOF_COUNT] }
    }

    /// How far any frame lay outside the limits before clamping, radians, and the name of that joint.
    #[must_use]
    pub fn worst(&self) -> (f32, &'static str) {
        let worst = (0..DOF_COUNT).max_by(|a, b| self.worst[*a].total_cmp(&self.worst[*b])).unwrap_or(0);
        (self.worst[worst], JOINT_NAMES[worst])
    }

    /// Joint angles of one frame, radians, within the limits.
    pub fn angles(&mut self, local_rotations: &[Quat; BODY_COUNT]) -> [f32; DOF_COUNT] {
        let mut angles = [0.0; DOF_COUNT];
        let mut at = 0;
        for (body, joint) in JOINTS {
            let rotation = local_rotations[body.index()];
            match joint {
                Joint::Hinge => {
                    angles[at] = wrap(2.0 * rotation.y.atan2(rotation.w));
                    at += 1;
                }
                Joint::Ball(order) => {
                    let (a, b, c) = rotation.to_euler(order);
                    let first = [a, b, c];
                    let second = [wrap(a + PI), wrap(PI - b), wrap(c + PI)];
                    let best = if self.cost(at, &second) < self.cost(at, &first) { second } else { first };
                    angles[at..at + 3].copy_from_slice(&best);
                    at += 3;
                }
            }
        }
        for (i, angle) in angles.iter_mut().enumerate() {
            self.worst[i] = self.worst[i].max(self.outside(i, *angle));
            *angle = angle.clamp(self.limits.low[i], self.limits.high[i]);
        }
        self.before = angles;
        angles
    }

    fn outside(&self, joint: usize, angle: f32) -> f32 {
        (self.limits.low[joint] - angle).max(angle - self.limits.high[joint]).max(0.0)
    }

    fn cost(&self, at: usize, angles: &[f32; 3]) -> f32 {
        let part = |(i, angle): (usize, &f32)| {
            self.outside(at + i, *angle) + wrap(angle - self.before[at + i]).abs()
        };
        angles.iter().enumerate().map(part).sum()
    }
}

/// The same angle in (-pi, pi].
fn wrap(angle: f32) -> f32 {
    angle - TAU * (angle / TAU).round()
}
