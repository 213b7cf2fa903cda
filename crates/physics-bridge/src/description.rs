//! The immutable half: an MJCF, compiled and checked, with its skeleton, ground and shapes. Imports neither
//! characters nor crowds.

pub(crate) mod body_poses;
pub(crate) mod file;
pub(crate) mod ground;
pub(crate) mod ground_kind;
pub(crate) mod layout;
mod logging;
pub(crate) mod mjcf;
pub(crate) mod model;
pub(crate) mod model_error;
pub(crate) mod settings;
pub(crate) mod shape;
mod skeleton;
pub(crate) mod terrain;
pub(crate) mod world_error;
