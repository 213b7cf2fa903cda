//! Steer physics-based characters by blending the parameters of tiny policies.
#![no_std]
#![forbid(unsafe_code)]

extern crate alloc;

mod body;
mod gamepad_state;
mod heading;
mod state;

pub use body::{BODY_COUNT, BODY_NAMES, Body, DOF_COUNT, JOINT_NAMES};
pub use gamepad_state::{Button, Buttons, GamepadState};
pub use heading::Heading;
pub use state::{BodyState, CharacterState, JointTargets};
