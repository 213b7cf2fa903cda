//! The humanoid of policy-core in MuJoCo: sense, actuate, step, save and restore.
//!
//! A [`Model`] is immutable and shared by any number of characters; a [`Character`] is the mutable state of
//! one body. SI units, world space, z up. MuJoCo writes quaternions wxyz and glam xyzw: the change is made
//! in this crate and nowhere else.
//!
//! MuJoCo's messages go to a handler that is installed when the first model is loaded, so nothing is
//! printed and no file is written into the working folder. A program that also uses mujoco-rs by itself
//! loads its first [`Model`] before it starts threads.

mod character;
mod contact;
mod crowd;
mod diverged;
mod dump;
mod ground;
mod ground_kind;
mod history;
mod layout;
mod logging;
mod mjcf;
mod model;
mod model_error;
mod plausibility;
mod pose;
mod push;
mod sense;
mod set_up;
mod settings;
mod shape;
mod snapshot;
mod terrain;

pub use character::Character;
pub use contact::Contact;
pub use crowd::{Crowd, CrowdError};
pub use diverged::{Cause, Diverged, Excess};
pub use dump::{Dump, DumpError};
pub use ground::HeightField;
pub use ground_kind::GroundKind;
pub use history::{HISTORY_SECS, NotRecorded};
pub use model::Model;
pub use model_error::ModelError;
pub use plausibility::{MAX_DEPTH_M, MAX_DISTANCE_M, MAX_SPEED_MPS, MAX_SPIN_RADPS};
pub use pose::{BodyPoses, Pose, PoseError};
pub use push::{MAX_PUSHED_MPS, PushError};
pub use set_up::{ModelMismatch, WALKING_START_MPS};
pub use settings::Settings;
pub use shape::{Shape, ShapeKind};
pub use snapshot::{Snapshot, SnapshotMismatch};
pub use terrain::Terrain;

/// Control ticks per second.
pub const CONTROL_HZ: u32 = 30;

/// Numbers in `qpos`: position (3) and rotation (4, wxyz) of the pelvis, then the 28 hinges in the order of
/// [`policy_core::JOINT_NAMES`].
pub const QPOS_LEN: usize = 7 + policy_core::DOF_COUNT;

/// Numbers in `qvel`: linear velocity of the pelvis in world axes (3), its angular velocity in its own axes
/// (3), then the 28 hinges in the order of [`policy_core::JOINT_NAMES`].
pub const QVEL_LEN: usize = 6 + policy_core::DOF_COUNT;
