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
mod command;
mod controller;
mod evaluator;
mod fall;
mod features;
mod gamepad_state;
mod graph;
mod heading;
mod judge;
mod kernel;
mod manifest;
mod mapper;
mod mlp;
mod normaliser;
mod observation;
mod pack;
mod pack_bytes;
mod pack_error;
mod report;
mod route;
mod skill;
mod state;

pub use action::{ActionScaling, ActionScalingError};
pub use batch::{BatchScratch, evaluate_batch_into};
pub use blend::{Blend, BlendFull, BlendTerm, MAX_BLEND_TERMS};
pub use body::{BODY_COUNT, BODY_NAMES, Body, DOF_COUNT, JOINT_NAMES};
pub use command::{Command, Goal};
pub use controller::{Controller, ControllerConfig};
pub use evaluator::{BlendEvaluator, BlendMode, Evaluation};
pub use features::{
    DISCRIMINATOR_INPUT_LEN, FRAME_AGES, FRAME_LEN, FrameHistory, HISTORY_LEN, discriminator_frame_into,
};
pub use gamepad_state::{Button, Buttons, GamepadState};
pub use graph::{Edge, GraphError, GraphPosition, MAX_NODES, Node, Path, PolicyGraph};
pub use heading::Heading;
pub use kernel::Arithmetic;
pub use manifest::{
    DISCRIMINATOR_LAYOUT, DiscriminatorEntry, EdgeEntry, Manifest, OBSERVATION_LAYOUT, PACK_FORMAT,
    PACK_VERSION, PathEntry, PolicyEntry, SkillEntry,
};
pub use mapper::{Bindings, CommandMapper};
pub use mlp::{Layer, MAX_LAYERS, MAX_WIDTH, Mlp, MlpError, MlpScratch};
pub use normaliser::{LEAST_DEVIATION, NORMALISED_LIMIT, Normaliser, NormaliserError};
pub use observation::{
    OBSERVATION_LEN, POLICY_INPUT_LEN, TARGET_LEN, TARGET_RANGE_METRES, observe_into, target_input,
};
pub use pack::{CharacterPack, PackTensors};
pub use pack_error::PackError;
pub use report::TickReport;
pub use route::RouteTable;
pub use skill::{EndCondition, Skill, SkillEnd, SkillProgress};
pub use state::{BodyState, CharacterState, JointTargets};
