//! Steer physics-based characters by blending the parameters of tiny policies.
#![no_std]
#![forbid(unsafe_code)]

extern crate alloc;

mod action;
mod body;
mod features;
mod gamepad_state;
mod heading;
mod normaliser;
mod observation;
mod state;

pub use action::{ActionScaling, ActionScalingError};
pub use body::{BODY_COUNT, BODY_NAMES, Body, DOF_COUNT, JOINT_NAMES};
pub use features::{
    DISCRIMINATOR_INPUT_LEN, FRAME_AGES, FRAME_LEN, FrameHistory, HISTORY_LEN, discriminator_frame_into,
};
pub use gamepad_state::{Button, Buttons, GamepadState};
pub use heading::Heading;
pub use normaliser::{LEAST_DEVIATION, NORMALISED_LIMIT, Normaliser, NormaliserError};
pub use observation::{
    OBSERVATION_LEN, POLICY_INPUT_LEN, TARGET_LEN, TARGET_RANGE_METRES, observe_into, target_input,
};
pub use state::{BodyState, CharacterState, JointTargets};
