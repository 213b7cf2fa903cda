//! Gamepads as plain [`GamepadState`]s: from devices, recordings and scripts.
//!
//! ```
//! let script = gamepad::Script::from_ron(
//!     "(entries: [(at: 1.0, ramp: 2.0, left_stick: (0.0, 1.0)), (at: 4.0, tap: [East])])",
//! )?;
//! assert_eq!(script.state_at(0.5).left_stick, [0.0, 0.0]);
//! assert_eq!(script.state_at(2.0).left_stick, [0.0, 0.5]);
//! assert!(script.state_at(4.05).buttons.contains(gamepad::Button::East));
//! # Ok::<(), gamepad::ScriptError>(())
//! ```

#![forbid(unsafe_code)]

pub mod backend;
pub mod calibration;
pub mod descriptor;
pub mod device;
pub mod doctor;
mod files;
mod gamepads;
mod input;
pub mod pads;
pub mod recording;
mod script;
mod session;
pub mod udev;

pub use gamepads::{Gamepads, Pad};
pub use input::{Battery, Motion, PadInput, PadReport, Power, ReportError, Touch, Update};
pub use pads::{Bus, NoGamepad, PadId};
pub use policy_core::{Button, Buttons, GamepadState};
pub use script::{MAX_SCRIPT_BYTES, MAX_SCRIPT_ENTRIES, MAX_SCRIPT_SECS, Script, ScriptError, TAP_SECS};
pub use session::{CALIBRATION_SECS, PadSession, SILENCE_SECS};
