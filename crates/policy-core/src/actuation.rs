//! How a character's motors were driven in training: what an engine needs to build the same body.

use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

/// A motor of one hinge. The torque is `gain * (target - angle)`, clamped to the force limit, less `damping * velocity`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointActuation {
    /// Newton metres per radian; at least 0.
    pub gain: f32,
    /// Newton metre seconds per radian; at least 0. A property of the joint, integrated implicitly, not clamped.
    pub damping: f32,
    /// Greatest torque of the gain, newton metres; at least 0.
    pub force_limit: f32,
    /// Inertia of the motor about the hinge, kilogram square metres; at least 0.
    pub armature: f32,
}

/// Motors, rate and mass of a character.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ActuationContract {
    /// Physics steps per second.
    pub physics_hz: f32,
    /// Mass of all bodies, kilograms.
    pub mass_kg: f32,
    /// One motor for each hinge, in the skeleton's order.
    pub joints: Vec<JointActuation>,
}

impl ActuationContract {
    /// The first number that is out of its range: its name and value.
    pub(crate) fn bad_number(&self) -> Option<(&'static str, f32)> {
        let joints = self.joints.iter().flat_map(|j| {
            [
                ("gain", j.gain),
                ("damping", j.damping),
                ("force_limit", j.force_limit),
                ("armature", j.armature),
            ]
        });
        let finite = |n: f32| n.is_finite() && n >= 0.0;
        let mut numbers =
            [("physics_hz", self.physics_hz), ("mass_kg", self.mass_kg)].into_iter().chain(joints);
        numbers.find(|(_, n)| !finite(*n))
    }
}
