//! What is known of a step that blew up.

use mujoco_rs::wrappers::mj_data::MjtWarning;
use policy_core::Body;

use crate::dump::Dump;

/// Which of MuJoCo's watches went off.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Warning {
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
}

impl Warning {
    /// All warnings in the order of MuJoCo's counters.
    pub(crate) const ALL: [Warning; MjtWarning::mjNWARNING as usize] = [
        Warning::SingularInertia,
        Warning::ContactsFull,
        Warning::ConstraintsFull,
        Warning::BadPosition,
        Warning::BadVelocity,
        Warning::BadAcceleration,
        Warning::BadControl,
    ];
}

impl std::fmt::Display for Warning {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Warning::SingularInertia => "a singular inertia matrix",
            Warning::ContactsFull => "more contacts than the memory holds",
            Warning::ConstraintsFull => "more constraints than the memory holds",
            Warning::BadPosition => "a position that is not finite or huge",
            Warning::BadVelocity => "a velocity that is not finite or huge",
            Warning::BadAcceleration => "an acceleration that is not finite or huge",
            Warning::BadControl => "a joint target that is not finite or huge",
        })
    }
}

/// The simulation of a character blew up. The character is back in its state before the tick.
#[derive(Debug, thiserror::Error)]
#[error("simulation diverged in tick {tick}, substep {substep}: expected finite motion, found {warning}{}", at(*body))]
#[non_exhaustive]
pub struct Diverged {
    /// Control ticks that the character had completed.
    pub tick: u64,
    /// Substep of the tick in which it happened, from 0.
    pub substep: u32,
    /// The watch that went off first.
    pub warning: Warning,
    /// The first body it named; `None` when it names none.
    pub body: Option<Body>,
    /// The state before the tick, to be saved and replayed.
    pub dump: Box<Dump>,
}

fn at(body: Option<Body>) -> String {
    body.map_or_else(String::new, |body| format!(" in body {}", body.name()))
}
