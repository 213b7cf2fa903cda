//! Steer physics-based characters by blending the parameters of tiny policies.
#![no_std]
#![forbid(unsafe_code)]

extern crate alloc;
#[cfg(feature = "std")]
extern crate std;

mod action;
mod batch;
mod blend;
mod body;
mod features;
mod gamepad_state;
mod heading;
mod kernel;
mod mlp;
mod normaliser;
mod observation;
mod state;

pub use action::{ActionScaling, ActionScalingError};
pub use batch::{BatchScratch, evaluate_batch_into};
pub use blend::{Blend, BlendFull, BlendTerm, MAX_BLEND_TERMS};
pub use body::{BODY_COUNT, BODY_NAMES, Body, DOF_COUNT, JOINT_NAMES};
pub use features::{
    DISCRIMINATOR_INPUT_LEN, FRAME_AGES, FRAME_LEN, FrameHistory, HISTORY_LEN, discriminator_frame_into,
};
pub use gamepad_state::{Button, Buttons, GamepadState};
pub use heading::Heading;
pub use kernel::Arithmetic;
pub use mlp::{Layer, MAX_LAYERS, MAX_WIDTH, Mlp, MlpError, MlpScratch};
pub use normaliser::{LEAST_DEVIATION, NORMALISED_LIMIT, Normaliser, NormaliserError};
pub use observation::{
    OBSERVATION_LEN, POLICY_INPUT_LEN, TARGET_LEN, TARGET_RANGE_METRES, observe_into, target_input,
};
pub use state::{BodyState, CharacterState, JointTargets};
