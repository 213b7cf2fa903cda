//! A character in MuJoCo or in Rapier behind one type: the measures and the demo choose an engine by its name.
//!
//! A [`Model`] is described by MuJoCo in either case: shapes, terrain, settings. A [`Character`] lives in the engine of
//! its model. What an engine lacks is said by [`Engine::keeps_history`] and the like, and not imitated.
//!
//! ```
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # const HUMANOID: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/humanoid.xml"));
//! use physics::{Character, Engine, Model, PhysicsCharacter};
//!
//! let described = physics_bridge::Model::from_mjcf(HUMANOID)?;
//! for engine in Engine::ALL {
//!     let mut character = Character::new(&Model::new(&described, engine)?);
//!     character.step()?;
//!     assert_eq!(character.tick(), 1, "in {}", engine.title());
//! }
//! # Ok(())
//! # }
//! ```

mod character;
mod engine;
mod history;
mod model;

pub use character::{Character, Diverged, Snapshot, SnapshotMismatch};
pub use engine::Engine;
pub use history::NotRecorded;
pub use model::{Model, ModelError, ModelMismatch};
pub use policy_core::contract::PhysicsCharacter;
