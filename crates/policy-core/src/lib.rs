//! Steer physics-based characters by blending the parameters of tiny policies.
//!
//! Each skill of a character is one small network, a *policy*. Policies that were trained towards each other form a
//! *graph*, and the straight line between the parameters of two neighbours is itself a good policy. A game moves along
//! that line with an analog trigger. The method is that of [*Policy-space Interpolation for
//! Physics-based Characters*](https://doi.org/10.1145/3747863) (Rocca, Andrews, Erleben, 2025), also known as *Lightweight Policy-Space
//! Control for Physics-Based Characters*. This crate holds what a game needs of it at run time that is not physics, drawing or devices.
//!
//! ```
//! use std::sync::Arc;
//! use policy_core::{CharacterPack, CharacterState, Command, Controller, FixedRate, Goal, glam::Vec2};
//!
//! # fn sense(state: &mut CharacterState) { state.bodies[0].position.z = 0.9 }
//! # fn actuate(joint_targets: &[f32]) { assert_eq!(joint_targets.len(), 28) }
//! # let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/humanoid.pack.safetensors");
//! let pack = Arc::new(CharacterPack::from_bytes(&std::fs::read(path)?)?);
//! let speed = pack.graph().path_named("speed").expect("the humanoid has a path of that name");
//! let mut controller = Controller::new(pack.clone());
//! let mut state = CharacterState::new(pack.skeleton());
//! let mut rate = FixedRate::new(pack.control_hz());
//!
//! for _frame in 0..60 {
//!     for _tick in 0..rate.advance(1.0 / 60.0) {
//!         sense(&mut state); // from your physics engine: world space, z up
//!         let command = Command {
//!             target: Some(Vec2::new(5.0, 0.0)),
//!             goal: Goal::Path { path: speed, coordinate: 1.0 }, // walk
//!             ..Command::default()
//!         };
//!         actuate(controller.tick(&state, &command, rate.period_secs())); // radians
//!     }
//! }
//! assert_eq!(pack.graph().node_named("walk"), controller.report().position.as_node());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # How the parts hang together
//! - [`CharacterPack`]: skeleton, policies, graph, skills, normalisers; immutable, shared by all characters.
//! - [`Controller`]: steers one character; [`Controller::tick`] neither allocates nor fails.
//! - [`ControllerState`]: what changes of a controller, as plain data to save, send and restore.
//! - [`CommandMapper`]: from a gamepad to a [`Command`]; or make your own.
//! - [`Blend`], [`Mlp`], [`evaluate_batch_into`]: the parts, for an engine with its own controller or a crowd.
//! - [`contract`]: what every physics has in common: poses, pushes, limits. [`format`](mod@format): the pack's manifest. [`training`]: what only a trainer needs.
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
mod actuation;
mod agility;
mod balance;
mod batch;
pub mod bindings;
mod blend;
mod capture_step;
mod catching;
mod command;
pub mod contract;
mod controller;
mod controller_state;
mod evaluator;
mod excerpt;
mod fall;
mod features;
mod fixed_rate;
mod footfall;
mod footing;
pub mod format;
mod format_one;
mod gamepad_state;
mod give_way;
mod graph;
mod ground;
mod heading;
mod ids;
mod kernel;
mod mapper;
mod mlp;
mod normaliser;
mod observation;
mod pack;
mod pack_bytes;
mod pack_error;
mod pack_parts;
mod path;
mod report;
mod rising;
mod route;
mod scorer;
mod skeleton;
mod skill;
mod starts_and_stops;
mod state;
mod state_bytes;
mod state_check;
mod steering;
mod strafe;
pub mod training;
mod turn_assist;
mod turning;
mod variants;

pub use glam;

pub use actuation::{ActuationContract, JointActuation};
pub use batch::{BatchScratch, evaluate_batch_into};
pub use bindings::Bindings;
pub use blend::Blend;
pub use command::{Command, Goal};
pub use controller::{Controller, ControllerConfig, SwapError};
pub use controller_state::{ControllerState, StateError};
pub use evaluator::{BlendEvaluator, BlendMode};
pub use fixed_rate::FixedRate;
pub use gamepad_state::{Button, Buttons, GamepadState};
pub use give_way::GiveWay;
pub use graph::PolicyGraph;
pub use ground::{
    FOOT_LOOKAHEAD_SECS, MAX_RISE_METRES, MAX_STEP_METRES, SHIN_LOOKAHEAD_SECS, ground_lookahead_secs,
};
pub use heading::Heading;
pub use ids::{BodyId, NodeId, PathId, PolicyId, SkillId};
pub use kernel::Arithmetic;
pub use mapper::CommandMapper;
pub use mlp::{Mlp, MlpScratch};
pub use observation::{observe_into, target_input};
pub use pack::CharacterPack;
pub use pack_error::PackError;
pub use path::GraphPosition;
pub use report::{StateFault, TickReport};
pub use skeleton::Skeleton;
pub use skill::{Refusal, Skill, SkillEnd};
pub use state::{BodyState, CharacterState, JointTargets};
pub use steering::Steering;
pub use turn_assist::TurnAssist;
