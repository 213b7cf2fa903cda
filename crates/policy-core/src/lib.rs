//! Steer physics-based characters by blending the parameters of tiny policies.
//!
//! Each skill of a character is one small network, a *policy*; policies that were trained towards each other form a
//! *graph*, and the straight line between the parameters of two neighbours is itself a good policy. A game moves along
//! that line with an analog trigger. The method is that of *Lightweight Policy-Space Control for Physics-Based
//! Characters*; this crate is everything of it that a game needs at run time and that is not physics, drawing or
//! devices.
//!
//! ```no_run
//! use std::sync::Arc;
//! use policy_core::{CharacterPack, CharacterState, Command, Controller, Goal};
//!
//! # fn sense() -> CharacterState { CharacterState::default() }
//! # fn actuate(_: &policy_core::JointTargets) {}
//! let bytes = std::fs::read("assets/humanoid.pack.safetensors")?;
//! let pack = Arc::new(CharacterPack::from_bytes(&bytes)?);
//! let mut controller = Controller::new(pack);
//! loop {
//!     let state: CharacterState = sense(); // from your physics engine
//!     let command = Command {
//!         target: Some(glam::Vec2::new(5.0, 0.0)),
//!         goal: Goal::Path { path: 0, coordinate: 1.5 },
//!         ..Command::default()
//!     };
//!     actuate(controller.tick(&state, &command, 1.0 / 30.0)); // 28 joint targets, radians
//! }
//! # #[allow(unreachable_code)] Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # How the parts hang together
//! - [`CharacterPack`]: policies, graph, skills, normalisers; immutable, shared by all characters.
//! - [`Controller`]: the state of one character; [`Controller::tick`] neither allocates nor fails.
//! - [`CommandMapper`]: from a gamepad to a [`Command`]; or make your own.
//! - [`Blend`], [`Mlp`], [`evaluate_batch_into`]: the parts, for an engine with its own controller or a crowd.
//!
//! # Conventions
//! SI units, radians, z up, right-handed. Quaternions are glam's (x, y, z, w). *Parameters* are the numbers of a
//! network; *blend weights* are mixing factors.
//!
//! # Features
//! - `std` (default): run-time detection of the processor's vector units. Without it the crate is `no_std` with
//!   `alloc`, and uses the units enabled at compile time.
//!
//! # Determinism
//! In [`Arithmetic::Reproducible`], the default, a controller gives the same bits on every machine.
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
pub use fall::RISE_SECONDS;
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
