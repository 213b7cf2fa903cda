//! Characters of policy-core in MuJoCo: sense, actuate, step, save and restore; alone, in a shared world, or in crowds.
//!
//! A [`Model`] is an immutable description: body, ground, skeleton. Any number of characters share it. A
//! [`Character`] is the mutable state of one body alone. A [`World`] holds many characters, props and fixtures that
//! touch each other. A [`Crowd`] steps many characters apart on all cores. The modules are on three floors that import
//! downwards only: descriptions, one simulation, many simulations.
//!
//! ```
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! use std::sync::Arc;
//! use physics_bridge::{Character, Model};
//! use policy_core::{CharacterPack, Command, Controller, Goal, glam::Vec2};
//!
//! # let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets");
//! # let pack = CharacterPack::from_bytes(&std::fs::read(format!("{root}/humanoid.pack.safetensors"))?)?;
//! let model = Model::for_pack(&pack)?;
//! let walk = pack.graph().node_named("walk").expect("the humanoid walks");
//! let mut controller = Controller::new(Arc::new(pack));
//! let mut character = Character::new(&model);
//! for _ in 0..90 {
//!     let target = Some(Vec2::new(10.0, 0.0));
//!     let command = Command { target, goal: Goal::Node(walk), ..Command::default() };
//!     character.control_tick(&mut controller, &command, 1.0 / model.control_hz())?;
//! }
//! assert!(character.centre_of_mass().x > 1.0, "it has walked a metre in three seconds");
//! # Ok(())
//! # }
//! ```
//!
//! # Conventions
//! SI units, radians, world space with z up. MuJoCo writes quaternions wxyz and glam xyzw: this crate alone converts
//! them. Bodies and hinges are in the order of the skeleton.
//!
//! # MuJoCo's messages
//! They go to a handler that is installed when the first model is loaded. Nothing is printed and no file is written
//! into the working folder. A program that also uses mujoco-rs by itself loads its first [`Model`] before it starts
//! threads.

mod cause;
mod character;
mod crowd;
mod description;
mod kinematics;
mod ring;
mod world;

pub use cause::{Cause, Excess};
pub use character::{
    Character, Contact, Diverged, HISTORY_SECS, ModelMismatch, ReplayFile, ReplayFileError, Snapshot,
    SnapshotMismatch, StateHash,
};
pub use crowd::{Crowd, CrowdError, Worlds};
pub use description::body_poses::BodyPoses;
pub use description::ground_kind::GroundKind;
pub use description::model::Model;
pub use description::model_error::ModelError;
pub use description::shape::{Shape, ShapeKind};
pub use description::terrain::Terrain;
pub use description::world_error::WorldError;
/// What policy-core says of every physics of a character.
pub use policy_core::contract::{
    CONTROL_HZ, DAMPING_RANGE, DescriptionError, FRICTION_RANGE, Fixture, FixtureShape, HeightField, Joint,
    MASS_RANGE_KG, MAX_DEPTH_M, MAX_DISTANCE_M, MAX_HEIGHTS, MAX_HULL_POINTS, MAX_PUSHED_MPS, MAX_SPEED_MPS,
    MAX_SPIN_RADPS, MAX_TRIANGLES, Motion, PhysicsCharacter, Pose, PoseError, Prop, PushError, ROPE_RANGE_M,
    SIZE_RANGE_M, SettingError, Settings, Solid, TRIANGLE_DEPTH_M, WALKING_START_MPS,
};
pub use ring::NotRecorded;
pub use world::{
    CharacterHandle, Divergence, Diverging, FixtureHandle, Grab, GrabHandle, Handle, JointHandle,
    LayoutMismatch, MAX_GRABS, Movable, Part, PropHandle, RayHit, Remedy, StageTimes, World, WorldContact,
    WorldEdit, WorldSnapshot, measure_stages,
};
