//! What can be wrong with a motion.

use mujoco_rs::wrappers::mj_data::MjtWarning;
use policy_core::BodyId;

use crate::description::layout::{JointPlace, Layout};

/// What was wrong with the motion after a step. The first seven are MuJoCo's own checks, after each substep;
/// the others are checked at the end of each control tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Cause {
    /// The inertia matrix is close to singular.
    SingularInertia,
    /// More contacts than the memory holds.
    ContactsFull,
    /// More constraints than the memory holds.
    ConstraintsFull,
    /// NaN, infinity or a huge value in `qpos`.
    BadPosition,
    /// NaN, infinity or a huge value in `qvel`.
    BadVelocity,
    /// NaN, infinity or a huge value in `qacc`.
    BadAcceleration,
    /// NaN, infinity or a huge value in the joint targets.
    BadControl,
    /// A body spins faster than [`MAX_SPIN_RADPS`](crate::MAX_SPIN_RADPS).
    SpinsTooFast,
    /// A body is faster than [`MAX_SPEED_MPS`](crate::MAX_SPEED_MPS).
    TooFast,
    /// The origin of a body is deeper in the ground than [`MAX_DEPTH_M`](crate::MAX_DEPTH_M).
    BelowGround,
    /// A body is further from the origin of the world than [`MAX_DISTANCE_M`](crate::MAX_DISTANCE_M).
    TooFarAway,
}

impl Cause {
    /// MuJoCo's checks in the order of its warning counters.
    pub(crate) const WARNINGS: [Cause; MjtWarning::mjNWARNING as usize] = [
        Cause::SingularInertia,
        Cause::ContactsFull,
        Cause::ConstraintsFull,
        Cause::BadPosition,
        Cause::BadVelocity,
        Cause::BadAcceleration,
        Cause::BadControl,
    ];

    /// The body that a number of MuJoCo's warning belongs to.
    pub(crate) fn body(self, layout: &Layout, index: usize) -> Option<BodyId> {
        let root = BodyId::new(0);
        let hinge =
            |fits: &dyn Fn(&JointPlace) -> bool| layout.joints.iter().find(|j| fits(j)).map(|j| j.body);
        match self {
            Cause::BadPosition => hinge(&|joint| joint.qpos == index).or(Some(root)),
            Cause::BadVelocity | Cause::BadAcceleration | Cause::SingularInertia => {
                hinge(&|joint| joint.dof == index).or(Some(root))
            }
            Cause::BadControl => hinge(&|joint| joint.ctrl == index),
            _ => None,
        }
    }

    /// Unit of the value and the limit; empty where there is none.
    pub(crate) fn unit(self) -> &'static str {
        match self {
            Cause::TooFast => " m/s",
            Cause::SpinsTooFast => " rad/s",
            Cause::BelowGround | Cause::TooFarAway => " m",
            _ => "",
        }
    }
}

impl std::fmt::Display for Cause {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Cause::SingularInertia => "a singular inertia matrix",
            Cause::ContactsFull => "more contacts than the memory holds",
            Cause::ConstraintsFull => "more constraints than the memory holds",
            Cause::BadPosition => "a position that is not finite or huge",
            Cause::BadVelocity => "a velocity that is not finite or huge",
            Cause::BadAcceleration => "an acceleration that is not finite or huge",
            Cause::BadControl => "a joint target that is not finite or huge",
            Cause::TooFast => "a body that is too fast",
            Cause::SpinsTooFast => "a body that spins too fast",
            Cause::BelowGround => "a body below the ground",
            Cause::TooFarAway => "a body too far from the origin",
        })
    }
}

/// What was measured, and how much of it is plausible.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Excess {
    /// What was found, in the unit that the cause names.
    pub value: f32,
    /// The largest plausible value.
    pub limit: f32,
}
