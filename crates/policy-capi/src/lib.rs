//! C interface of `policy-core`: character packs and controllers behind opaque handles, for engines in any language.
//!
//! The header is `include/policy_space.h`; `examples/walk.c` is a whole program. The functions check what a border can
//! check: null pointers, counts, indices and numbers. Behind them [`policy_core`] does the work.
//!
//! # Contract of every function
//! A pointer is null or aligned, and valid for its type and count during the call. A handle comes from this library and is
//! not freed yet. A [`PsController`] or [`PsState`] is used by one thread at a time. What a function writes to is not read or
//! written by others meanwhile.
//!
//! # Errors
//! Functions return a [`PsStatus`], or a null pointer, 0 or [`PS_NONE`] on failure. [`ps_last_error`] tells the calling thread
//! why its last call failed. Panics end at the border as [`PsStatus::Panic`].
//!
//! # Allocation
//! Functions named `new`, `from_bytes`, `from_file` and `set_pack` allocate. No other does, with or without an error.
#![deny(unsafe_op_in_unsafe_fn)]
#![allow(clippy::missing_safety_doc, reason = "one contract for all functions, above and in the header")]

// The order of the header.
mod border;
mod error;
mod pack;

mod describe;

mod command;
mod config;
mod controller;
mod report;
mod sensed;
mod state;

pub use command::{PsBlendTerm, PsCommand, PsGoal};
pub use config::{PsArithmetic, PsBlendMode, PsConfig, ps_config_default};
pub use controller::*;
pub use describe::*;
pub use error::{PsStatus, ps_last_error, ps_last_status, ps_status_name};
pub use pack::*;
pub use report::{PsEvaluation, PsFault, PsPosition, PsRefusal, PsReport, PsSkillEnd, ps_controller_report};
pub use sensed::{PsBody, PsSensed};
pub use state::*;

/// Version of this interface. It changes whenever a function or struct changes in a way that a compiled program would
/// notice.
pub const PS_ABI_VERSION: u32 = 1;

/// Stands for "none" where an index is expected.
pub const PS_NONE: i32 = -1;

/// Most layers of a policy.
pub const PS_MAX_LAYERS: usize = 4;

/// Most policies of a blend.
pub const PS_MAX_BLEND_TERMS: usize = 16;

const _: () = assert!(PS_MAX_LAYERS == policy_core::training::MAX_LAYERS);
const _: () = assert!(PS_MAX_BLEND_TERMS == policy_core::training::MAX_BLEND_TERMS);

/// `PS_ABI_VERSION` of the library that is loaded; compare it with that of the header.
#[unsafe(no_mangle)]
pub extern "C" fn ps_abi_version() -> u32 {
    PS_ABI_VERSION
}
