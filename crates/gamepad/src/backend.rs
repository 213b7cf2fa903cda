//! Back ends: where devices and their reports come from.

#[cfg(feature = "gilrs")]
mod gilrs;
#[cfg(feature = "hidapi")]
mod hid;

use std::time::Instant;

#[cfg(feature = "gilrs")]
pub use gilrs::GilrsBackend;
#[cfg(feature = "hidapi")]
pub use hid::HidBackend;

use crate::device::{DeviceEvent, DeviceKey};

/// A source of pads. Nothing here waits: a back end that must wait has a thread of its own.
pub trait PadBackend {
    /// Appends everything that happened since the last call.
    fn poll_into(&mut self, events: &mut Vec<(Instant, DeviceEvent)>);

    /// Sends an output report to a device; false when the device can't take it.
    fn send(&mut self, key: DeviceKey, report: &[u8]) -> bool;
}

/// Why a back end can't start.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BackendError {
    /// hidapi can't start.
    #[error("hidapi cannot start: {message}")]
    Hid {
        /// What it says.
        message: String,
    },
    /// gilrs can't start.
    #[error("gilrs cannot start: {message}")]
    Gilrs {
        /// What it says.
        message: String,
    },
    /// The system gives no thread.
    #[error("no thread for reading pads: {0}")]
    Thread(std::io::Error),
}

impl From<std::io::Error> for BackendError {
    fn from(error: std::io::Error) -> Self {
        Self::Thread(error)
    }
}

/// A key that no device had before.
#[cfg(any(feature = "hidapi", feature = "gilrs"))]
fn new_key() -> DeviceKey {
    use std::sync::atomic::{AtomicU64, Ordering};
    static NEXT: AtomicU64 = AtomicU64::new(1);
    DeviceKey(NEXT.fetch_add(1, Ordering::Relaxed))
}
