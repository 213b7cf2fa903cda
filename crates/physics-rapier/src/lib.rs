//! Characters of policy-core in Rapier: sense, actuate, step, in a game's world or in one of their own.
//!
//! The same policies run here that were trained in MuJoCo, and the functions have the names of physics-bridge where
//! they mean the same. A [`Model`] is an immutable description, made of an MJCF. An [`Articulation`] is one character
//! inside any Rapier world, such as a game's. A [`Character`] is one character alone in a world of its own. A [`World`] has
//! several of them, and props, that touch each other.
//!
//! ```
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! use std::sync::Arc;
//! use physics_rapier::{Character, Model};
//! use policy_core::{CharacterPack, Command, Controller};
//!
//! # let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets");
//! # let pack = CharacterPack::from_bytes(&std::fs::read(format!("{root}/humanoid.pack.safetensors"))?)?;
//! let model = Model::for_pack(&pack)?;
//! let mut controller = Controller::new(Arc::new(pack));
//! let mut character = Character::new(&model);
//! for _ in 0..10 {
//!     character.control_tick(&mut controller, &Command::default(), 1.0 / model.control_hz())?;
//! }
//! assert_eq!(character.tick(), 10);
//! # Ok(())
//! # }
//! ```
//!
//! # Conventions
//! SI units, radians, world space with z up. Bodies and hinges are in the order of the skeleton. [`Pose`] is laid out
//! as MuJoCo does, quaternions wxyz. Rapier's vectors and rotations are policy-core's: both use one version of glam.
//!
//! # What is done about Rapier
//! | Rapier and its MJCF loader | here |
//! |---|---|
//! | integrate a free root as if its centre of mass were its origin | the root's frame is moved to its centre of mass |
//! | report the body velocities of the last substep's start | velocities follow from the generalised ones |
//! | skip planes | [`Character`] has the ground of the MJCF; a game brings its own |
//! | let all limbs touch each other | those touch that do in MuJoCo, the humanoid's legs; characters touch each other |
//! | damp a free root, let links sleep | neither |
//! | have rigid joint limits | limits are as soft as MuJoCo's default ones |
//! | have stiff contacts with the ground | [`Drive::tune`] makes them about as soft as MuJoCo's |
//! | hold a foot in every direction alike | friction is 0.8 of the MJCF's, the mean of MuJoCo's pyramid |
//! | lose impulses on links | pushes and impulses are forces |
//! | read the files that an MJCF names | such an MJCF is refused |
//!
//! MuJoCo's `solref`, `solimp`, cone and solver options have no effect. Feet slip less than in MuJoCo, so characters
//! walk about 10 % slower.
//!
//! # Features
//! `enhanced-determinism` turns on Rapier's: the same bits on every processor and under wasm32.

mod articulation;
mod character;
mod mjcf;
mod model;
mod model_error;
mod saved;
mod skeleton;
mod world;

pub use articulation::{Articulation, Drive, PlaceError, Removed, Sets};
pub use character::{Cause, Character, Diverged, ModelMismatch, Snapshot, SnapshotMismatch};
pub use model::Model;
pub use model_error::ModelError;
/// What policy-core says of every physics of a character.
pub use policy_core::contract::{
    CONTROL_HZ, DescriptionError, Fixture, FixtureShape, HeightField, Joint, MAX_DEPTH_M, MAX_DISTANCE_M,
    MAX_PUSHED_MPS, MAX_SPEED_MPS, MAX_SPIN_RADPS, Motion, PhysicsCharacter, Pose, PoseError, Prop,
    PushError, SettingError, Settings, Solid, WALKING_START_MPS,
};
/// Rapier as this crate uses it.
pub use rapier3d;
pub use world::{World, WorldError, WorldSnapshot};
